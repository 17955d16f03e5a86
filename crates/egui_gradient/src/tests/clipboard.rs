//! Tests of copying and pasting stops.

use super::*;

#[test]
fn stops_are_copied_and_pasted_as_text() {
    let mut harness = host(&[(0.0, 0), (0.2, 10), (1.0, 20)]);
    let copied = |harness: &Harness<'_, Host>| {
        let commands = &harness.output().platform_output.commands;
        commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    };
    harness.get_by_label("stop 1").focus();
    harness.run_steps(2);
    harness.event(Event::Copy);
    harness.step();
    let text = copied(&harness).unwrap();
    let before = harness.state().row.clone();
    key(&mut harness, Key::Delete, NONE);
    harness.event(Event::Paste(text));
    harness.run_steps(3);
    assert_eq!(harness.state().row, before);
    assert_eq!(steps(&harness), ["remove a stop", "paste stops"]);
    harness.event(Event::Paste("no row".into()));
    harness.run_steps(3);
    assert_eq!(harness.state().row, before);
    assert!(harness.state().refused[0].starts_with("Cannot paste: pasted text:1:"), "{:?}", harness.state().refused);
    // A paste while another widget has focus is ignored, unless it was requested by the button.
    harness.get_by_label("Distribute").focus();
    harness.run_steps(2);
    harness.event(Event::Paste("no row".into()));
    harness.run_steps(2);
    assert_eq!(harness.state().refused.len(), 1);
    harness.get_by_label("Paste").click();
    harness.run_steps(2);
    harness.event(Event::Paste("no row".into()));
    harness.run_steps(2);
    assert_eq!(harness.state().refused.len(), 2);
}
