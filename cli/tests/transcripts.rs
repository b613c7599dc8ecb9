//! Recorded transcripts of the command: documentation and test at once. Those of the README and the book are among them.

#[test]
fn transcripts() {
    trycmd::TestCases::new()
        .case("tests/cmd/*.trycmd")
        .case("../README.md")
        .case("../docs/*.md")
        .case("../docs/*/*.md")
        .case("../docs/*/*/*.md")
        .env("NO_COLOR", "1")
        .run();
}

/// The README's block of text is what the tutorial's demo prints, and that is a transcript.
#[test]
fn the_readme_shows_what_the_tutorial_runs() {
    let read = |page: &str| {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        std::fs::read_to_string(root.join(page)).unwrap()
    };
    let readme = read("README.md");
    let (_, block) = readme.split_once("```text\n").expect("a block of text");
    let (block, _) = block.split_once("```").expect("its end");
    assert!(
        read("docs/tutorial.md").contains(&format!("$ swimmer demo -o lab\n{block}")),
        "the README shows\n{block}"
    );
}
