//! The planner's balanced counts as tables.

use std::fmt::Write as _;

use darrt_core::observe::accounts::{Accounts, Bucket};

use super::table;
use darrt_task::text::counted;

/// Pairs of bodies that are listed.
const PAIRS: usize = 10;

/// Where the attempts of every primitive ended, and which bodies were most often in the way.
pub(crate) fn report(accounts: &Accounts) -> String {
    let mut text = format!(
        "{}: {} met their target, {} added nothing; {} added; {} refused by the verifier, {} given up for a blocked motion\n\
         Every extension ends in one row of each primitive's column.\n",
        counted(accounts.extensions, "extension"),
        accounts.met,
        accounts.empty,
        counted(accounts.added, "state"),
        counted(accounts.refused, "plan"),
        accounts.withdrawn
    );
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", counts(accounts));
    let blocks = accounts.worst_blocks(PAIRS);
    if !blocks.is_empty() {
        let _ = write!(text, "\n{}", pairs(&blocks));
    }
    text
}

/// One column per primitive, one row per bucket that is not empty, and the sum of all.
fn counts(accounts: &Accounts) -> String {
    let rows: Vec<_> = accounts.rows().collect();
    let names = rows.iter().map(|(name, _)| name.replace('-', "-\n"));
    let mut table = table::with_header(std::iter::once("ends in".to_owned()).chain(names));
    for bucket in Bucket::ALL {
        let of = |counts: &[u64; Bucket::ALL.len()]| counts.get(bucket as usize).copied().unwrap_or(0);
        if rows.iter().any(|(_, counts)| of(counts) > 0) {
            let cells = rows.iter().map(|(_, counts)| shown(of(counts)));
            table.add_row(std::iter::once(bucket.heading().to_owned()).chain(cells));
        }
    }
    let sums = rows.iter().map(|(_, counts)| counts.iter().sum::<u64>().to_string());
    table.add_row(std::iter::once("all".to_owned()).chain(sums));
    table::finished(table, 1..=rows.len())
}

fn shown(count: u64) -> String {
    if count == 0 { "\u{b7}".to_owned() } else { count.to_string() }
}

fn pairs(blocks: &[(&(String, String), u64)]) -> String {
    let mut table = table::with_header(["most often in the way", "and", "times"]);
    for ((first, second), count) in blocks {
        table.add_row([first.clone(), second.clone(), count.to_string()]);
    }
    table::finished(table, [2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_are_rows_and_columns_sum_to_the_extensions() {
        let mut accounts = Accounts::new(vec!["Push", "Straight-Line-Arm-Transit"]);
        accounts.count(&[Bucket::Accepted, Bucket::NotUseful], 3, true, None);
        accounts.count(&[Bucket::NoContact, Bucket::NotUseful], 0, false, None);
        let text = report(&accounts);
        assert!(text.starts_with("2 extensions: 1 met their target, 1 added nothing; 3 states added"), "{text}");
        let line = |word: &str| text.lines().find(|line| line.trim_start().starts_with(word)).unwrap().to_owned();
        assert_eq!(line("accepted").split_whitespace().collect::<Vec<_>>(), ["accepted", "1", "\u{b7}"]);
        assert_eq!(line("all").split_whitespace().collect::<Vec<_>>(), ["all", "2", "2"]);
        assert!(!text.contains("unreachable") && !text.contains("in the way"));
    }
}
