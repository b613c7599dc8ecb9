//! Items without their bodies, their documentation and what nobody outside can name.

use syn::{Attribute, Block, Fields, ImplItem, Item, ItemImpl, TraitItem, Visibility, parse_quote};

/// The item as a caller sees it.
pub(super) fn of_item(item: &Item) -> Item {
    let mut item = item.clone();
    match &mut item {
        Item::Const(item) => keep(&mut item.attrs),
        Item::Static(item) => keep(&mut item.attrs),
        Item::Type(item) => keep(&mut item.attrs),
        Item::Fn(item) => {
            keep(&mut item.attrs);
            *item.block = empty();
        }
        Item::Struct(item) => {
            keep(&mut item.attrs);
            public_only(&mut item.fields);
        }
        Item::Enum(item) => {
            keep(&mut item.attrs);
            for variant in &mut item.variants {
                keep(&mut variant.attrs);
                for field in &mut variant.fields {
                    keep(&mut field.attrs);
                }
            }
        }
        Item::Trait(item) => {
            keep(&mut item.attrs);
            for inner in &mut item.items {
                match inner {
                    TraitItem::Fn(function) => {
                        keep(&mut function.attrs);
                        if let Some(body) = &mut function.default {
                            *body = empty();
                        }
                    }
                    TraitItem::Const(constant) => keep(&mut constant.attrs),
                    TraitItem::Type(associated) => keep(&mut associated.attrs),
                    _ => {}
                }
            }
        }
        _ => {}
    }
    item
}

/// An `impl` as a caller sees it; none where it has nothing public.
pub(super) fn of_impl(whole: &ItemImpl) -> Option<ItemImpl> {
    let mut stub = whole.clone();
    keep(&mut stub.attrs);
    let of_a_trait = stub.trait_.is_some();
    stub.items.retain_mut(|item| match item {
        ImplItem::Fn(function) => {
            keep(&mut function.attrs);
            function.block = empty();
            // What a trait asks for, the trait tells.
            !of_a_trait && matches!(function.vis, Visibility::Public(_))
        }
        ImplItem::Const(constant) => {
            keep(&mut constant.attrs);
            !of_a_trait && matches!(constant.vis, Visibility::Public(_))
        }
        ImplItem::Type(associated) => {
            keep(&mut associated.attrs);
            true
        }
        _ => false,
    });
    (of_a_trait || !stub.items.is_empty()).then_some(stub)
}

fn public_only(fields: &mut Fields) {
    match fields {
        Fields::Named(named) => {
            named.named = std::mem::take(&mut named.named)
                .into_iter()
                .filter(|field| matches!(field.vis, Visibility::Public(_)))
                .map(|mut field| {
                    keep(&mut field.attrs);
                    field
                })
                .collect();
        }
        Fields::Unnamed(unnamed) => {
            for field in &mut unnamed.unnamed {
                keep(&mut field.attrs);
                if !matches!(field.vis, Visibility::Public(_)) {
                    field.ty = parse_quote!(_);
                }
            }
        }
        Fields::Unit => {}
    }
}

/// What changes how an item can be used.
fn keep(attributes: &mut Vec<Attribute>) {
    attributes.retain(|attribute| {
        ["derive", "non_exhaustive", "cfg", "must_use"]
            .iter()
            .any(|kept| attribute.path().is_ident(kept))
    });
}

fn empty() -> Block {
    parse_quote!({})
}
