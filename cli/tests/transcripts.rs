//! Recorded transcripts of the command: documentation and test at once. Those of the README and the book are among them.

#[test]
fn transcripts() {
    trycmd::TestCases::new()
        .case("tests/cmd/*.trycmd")
        .case("../README.md")
        .case("../docs/*.md")
        .case("../docs/*/*.md")
        .env("NO_COLOR", "1")
        .run();
}
