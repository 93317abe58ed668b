use super::*;

#[test]
fn accepts_what_xml_allows() {
    for text in [
        "",
        "<a/>",
        "<?xml version=\"1.0\"?><a b='1' c = \"2>3\" ><!-- <b><c> - x --><![CDATA[<d>]]]]><e /></a >",
        "<a>text &amp; ' \" > more</a>",
    ] {
        assert!(check(text).is_ok(), "{text}: {:?}", check(text));
    }
}

#[test]
fn refuses_what_readers_could_read_otherwise() {
    for text in [
        "<a",
        "<a>",
        "</a>",
        "<a></a></a>",
        "<a b></a>",
        "<a b=c></a>",
        "<a b='<c>'></a>",
        "<a b='1></a>",
        "<a b='1'c='2'/>",
        "<a / >",
        "<a b>='</a>'></a>",
        "<!-- a -- b -->",
        "<!-- a",
        "<?pi ? > <b> ?>",
        "<?pi",
        "<![CDATA[ ]]",
        "< a/>",
        "<a\"b/>",
    ] {
        assert!(matches!(check(text), Err(UrdfError::Malformed { .. })), "{text}: {:?}", check(text));
    }
}

#[test]
fn refuses_a_document_type() {
    let text = "<?xml version='1.0'?><!DOCTYPE r [<!ENTITY a 'b'>]><r>&a;</r>";
    assert!(matches!(check(text), Err(UrdfError::DocumentType { offset: 21 })));
}

#[test]
fn bounds_nesting_exactly() {
    let nested = |n: usize| format!("{}{}", "<a>".repeat(n), "</a>".repeat(n));
    assert!(check(&nested(MAX_DEPTH)).is_ok());
    for n in [MAX_DEPTH + 1, 10_000, 1_000_000] {
        assert!(matches!(check(&nested(n)), Err(UrdfError::TooDeep { depth: 65, bound: 64, .. })));
    }
    // Unclosed tags are no way around it.
    assert!(matches!(check(&"<a>".repeat(1_000_000)), Err(UrdfError::TooDeep { .. })));
}

#[test]
fn there_is_one_root_and_nothing_beside_it() {
    assert!(check("\u{feff}<?xml version='1.0'?>\n<!-- a --> <r><a/></r>\n<!-- b -->\n").is_ok());
    for text in ["<r/>and more", "<r></r><r/>", "first <r/>", "<r/>\n<!-- b --> x"] {
        assert!(matches!(check(text), Err(UrdfError::Malformed { .. })), "{text}");
    }
}

#[test]
fn bounds_size_count_and_tags() {
    assert!(matches!(check(&" ".repeat(20 << 20)), Err(UrdfError::TooLarge { what: "text", .. })));
    let many = format!("<r>{}</r>", "<a/>".repeat(MAX_ELEMENTS));
    assert!(matches!(check(&many), Err(UrdfError::TooMany { what: "elements", .. })));
    let attributes: String = (0..20_000).flat_map(|i| [" a".to_owned(), i.to_string(), "='0'".to_owned()]).collect();
    assert!(matches!(check(&format!("<a{attributes}/>")), Err(UrdfError::TooLarge { what: "tag", .. })));
    let spaces: String = (0..100).flat_map(|i| [" xmlns:a".to_owned(), i.to_string(), "='0'".to_owned()]).collect();
    assert!(matches!(check(&format!("<a{spaces}/>")), Err(UrdfError::TooMany { what: "namespaces", .. })));
}
