//! Names of the parts of a file in one line: a file may have any number of them.

use std::collections::BTreeSet;
use std::fmt::Display;

use haze_core::error::one_line;

/// Names that a message lists.
const LISTED_NAMES: usize = 4;

/// The first names, and the number of the others.
pub fn listed(names: &BTreeSet<impl Display>) -> String {
    let shown: Vec<_> = names.iter().take(LISTED_NAMES).map(one_line).collect();
    let others = names.len().saturating_sub(LISTED_NAMES);
    let more = if others > 0 { format!(" and {others} more") } else { String::new() };
    shown.join(", ") + &more
}
