use proptest::prelude::*;
use proptest::sample::select;

use super::*;
use crate::renderer::shader::{Sources, sources};

/// Text of a compute shader with these statements.
fn shader(statements: &str) -> String {
    format!(
        "@group(0) @binding(0) var<storage, read_write> out: vec4f;\n\
         @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3u) {{\n\
         var x = i32(id.x); var b = x > 1; var v = vec4f(f32(x));\n\
         {statements}\nout = v + f32(x) + f32(b); }}\n"
    )
}

/// Texts that nest one kind of syntax `count` times, with the name of the kind.
fn nested(count: usize) -> Vec<(&'static str, String)> {
    let repeat = |part: &str| part.repeat(count);
    let around = |open: &str, inside: &str, close: &str| format!("{}{inside}{}", repeat(open), repeat(close));
    let statements = [
        ("else if", format!("if x == 0 {{ x = 1; }} {}", repeat("else if x == 2 { x = 3; } "))),
        ("constants", format!("x = 1{};", repeat("+1"))),
        ("sum", format!("x = x{};", repeat("+ /* ; */ x"))),
        ("and", format!("b = b{};", repeat("&&b"))),
        ("comparison", format!("b = x{};", repeat("<x"))),
        ("comparisons around parentheses", format!("b = (x){};", repeat("<x>(x)"))),
        ("not", format!("b = {}b;", repeat("!"))),
        ("minus", format!("x = {}x;", repeat("- "))),
        ("pointers", format!("{}x = 1;", repeat("*&"))),
        ("components", format!("v = v{};", repeat(".xyzw"))),
        ("components of a number", format!("x = 1f{};", repeat(".x"))),
        ("indices", format!("v.x = v{};", repeat("[0]"))),
        ("parentheses", format!("x = {};", around("(", "x", ")"))),
        ("sums in parentheses", format!("x = {};", around("(x+", "x", ")"))),
        ("sums of parentheses", format!("x = {};", around("(", "x", "+x)"))),
        ("calls", format!("x = {};", around("abs(", "x", ")"))),
        ("last arguments", format!("x = {};", around("min(x, ", "x", ")"))),
        ("types in a sum", format!("v.x = 1.0{};", repeat("+array<f32, 1>(1.0)[0]"))),
        ("blocks", around("{", "x = 1;", "}")),
        ("if", around("if b {", "x = 1;", "}")),
        ("if in else", around("if b { } else {", "x = 1;", "}")),
        ("loop", around("loop { if b { break; } ", "x = 1;", "}")),
        ("switch", around("switch x { default: {", "x = 1;", "}}")),
        ("types", format!("var t: {};", around("array<", "f32", ", 1>"))),
        ("template arguments", format!("var t: {};", around("array<1, ", "f32", ">"))),
        ("unclosed parentheses", format!("x = {}", repeat("("))),
        ("unclosed blocks", repeat("{")),
    ];
    statements.map(|(name, statements)| (name, shader(&statements))).into()
}

#[test]
fn every_kind_of_nesting_is_refused_in_one_line() {
    for (name, text) in &nested(MAX_DEPTH + 1) {
        let refused = check_nesting(text).unwrap_err();
        assert_eq!(refused.line, 4, "{name}");
        assert!(refused.reason.starts_with("nested more than 40 deep; expected fewer"), "{name}: {}", refused.reason);
        assert!(!refused.reason.contains('\n'));
    }
    let chain = |link: &dyn Fn(usize) -> String| (0..=MAX_DECLARATIONS).map(link).collect::<String>();
    for declarations in [
        chain(&|link| format!("const c{link} = c{};\n", link + 1)),
        chain(&|link| format!("struct S{link} {{ s: S{} }}\n", link + 1)),
        chain(&|link| format!("fn f{link}() {{ f{}(); }}\n", link + 1)),
    ] {
        let refused = check_nesting(&declarations).unwrap_err();
        assert_eq!((refused.line, refused.reason.contains("more than 720 declarations")), (721, true));
    }
}

/// Parses and validates a text, which may be invalid. A stack that overflows ends the process.
fn compile_on_a_small_stack(name: &str, text: String) {
    // naga is optimised in tests: 40 levels fit in a sixth of this. Without optimisation they take half of 2 MiB.
    const STACK: usize = 512 << 10;
    let compile = move || {
        let module = naga::front::wgsl::parse_str(&text).ok()?;
        let flags = naga::valid::ValidationFlags::all();
        let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::all());
        validator.validate(&module).ok()
    };
    let thread = std::thread::Builder::new().name(name.into()).stack_size(STACK);
    thread.spawn(compile).unwrap().join().unwrap();
}

#[test]
fn accepted_texts_compile_on_a_small_stack() {
    for count in 1..=MAX_DEPTH {
        for (name, text) in nested(count) {
            if check_nesting(&text).is_ok() {
                compile_on_a_small_stack(name, text);
            }
        }
    }
}

#[test]
fn what_is_long_but_not_deep_is_accepted() {
    let list = |part: &str| part.repeat(1000);
    for statements in [
        list("x = x + 1;"),
        list("if b { x = 1; } "),
        list("if b { x = 1; } else { x = 2; } "),
        format!("switch x {{ {} default: {{ }} }}", list("case 1 + 1: { x = 1; }")),
        format!("var t = array({});", list("vec3<f32>(1.0, -0.5, 1e-3), ")),
        format!("/* {} // */", list("((((")),
        format!("// {}", list("((((")),
        list("/* /* ( */ ( */"),
    ] {
        assert_eq!(check_nesting(&shader(&statements)), Ok(()), "{}", &statements[..30]);
    }
    let members: String = (0..1000).map(|member| format!("m{member}: vec4<f32>, ")).collect();
    assert_eq!(check_nesting(&format!("struct S {{ {members} }}")), Ok(()));
}

#[test]
fn the_place_counts_characters() {
    let text = format!("// ü\nconst A = /* ü */ 1{};", "+1".repeat(MAX_DEPTH));
    // The `=` counts too.
    let location = check_nesting(&text).map_err(|refused| (refused.line, refused.column)).unwrap_err();
    assert_eq!(location, (2, 20 + 2 * (MAX_DEPTH - 1)));
}

#[test]
fn embedded_shaders_are_well_below_the_limits() {
    let mut most = Measured::default();
    for (name, _) in sources().iter().filter(|(name, _)| !name.contains('/')) {
        let text = Sources::embedded().compose(name).unwrap().text;
        let measured = measure(&text, usize::MAX, usize::MAX).unwrap();
        most.depth = most.depth.max(measured.depth);
        most.declarations = most.declarations.max(measured.declarations);
        println!("{name}: {measured:?}");
    }
    // Room for the edits of a shader author.
    assert!(4 * most.depth <= 3 * MAX_DEPTH && 2 * most.declarations <= MAX_DECLARATIONS, "{most:?}");
}

/// A random expression or statement of nested parts.
fn nested_at_random() -> impl Strategy<Value = String> {
    let parts = select(vec![
        ("(", ")"),
        ("abs(", ")"),
        ("-", ""),
        ("!", ""),
        ("", "+x"),
        ("", ".x"),
        ("", "[0]"),
        ("x<", ""),
        ("array<i32, 1>(", ")[0]"),
        ("select(x, ", ", b)"),
        ("/* ( */", "// )\n"),
        ("vec2<i32>(", ").x"),
        ("x & ", ""),
        ("b && ", ""),
        ("*&", ""),
    ]);
    let statements = select(vec![
        ("{", "}"),
        ("if b {", "}"),
        ("if b { x = 1; } else ", ""),
        ("if b { } else {", "}"),
        ("loop { if b { break; }", "}"),
        ("for (var i = 0; i < x; i++) {", "}"),
        ("while b {", "}"),
        ("switch x { case 1, default: {", "}}"),
        ("{ x = 1; ", "; }"),
        ("", ";;"),
    ]);
    let around = |inside: String, parts: Vec<((&str, &str), usize)>| {
        parts.into_iter().fold(inside, |inside, ((open, close), count)| {
            format!("{}{inside}{}", open.repeat(count), close.repeat(count))
        })
    };
    // Rarely long, so that many texts are accepted.
    let count = prop_oneof![8 => 1_usize..12, 1 => 1_usize..2 * MAX_DEPTH];
    let expression =
        proptest::collection::vec((parts, count.clone()), 1..8).prop_map(move |parts| around("x".into(), parts));
    (expression, proptest::collection::vec((statements, count), 0..5))
        .prop_map(move |(expression, statements)| around(format!("{{ x = i32({expression}); }}"), statements))
}

#[test]
fn random_nesting_is_refused_or_compiles_on_a_small_stack() {
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(statements in nested_at_random())| {
        let text = shader(&statements);
        if check_nesting(&text).is_ok() {
            compile_on_a_small_stack("random", text);
        }
    });
}
