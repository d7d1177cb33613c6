//! Counts how many keys of many profiles are mapped, ignored, lost and unknown:
//! `cargo run --release -p slicerprofile --example coverage -- FILES…`. Files
//! that cannot be read as profiles are counted, and listed with the reason.

use slicerprofile::{Source, translate};
use std::collections::BTreeMap;
use std::path::Path;

fn main() {
    let mut all = [0_usize; 4];
    let mut names = [const { BTreeMap::<String, usize>::new() }; 4];
    let (mut profiles, mut failed) = (0, 0);
    for path in std::env::args().skip(1) {
        let source = match Source::open(Path::new(&path), &[]) {
            Ok(source) => source,
            Err(error) => {
                failed += 1;
                eprintln!("{error}");
                continue;
            }
        };
        let listed = source.list();
        let chosen: Vec<Vec<String>> = if listed.is_empty() {
            vec![Vec::new()]
        } else {
            let name = |n: &slicerprofile::Named| {
                vec![format!("{}:{}", n.kind.word(), n.name)]
            };
            listed.iter().map(name).collect()
        };
        for names_of in chosen {
            let picked = match source.pick(&names_of) {
                Ok(picked) => picked,
                Err(error) => {
                    failed += 1;
                    eprintln!("{error}");
                    continue;
                }
            };
            profiles += 1;
            let out = translate(&picked);
            let made = out.settings.iter().flat_map(|s| s.from.clone());
            let mut made: Vec<String> = made.collect();
            made.sort();
            made.dedup();
            let keys = |left: &[slicerprofile::Left]| -> Vec<String> {
                left.iter().map(|l| l.key.clone()).collect()
            };
            let lists = [
                made,
                keys(&out.ignored),
                keys(&out.lost),
                keys(&out.unknown),
            ];
            for (i, keys) in lists.into_iter().enumerate() {
                all[i] += keys.len();
                for key in keys {
                    *names[i].entry(key).or_default() += 1;
                }
            }
        }
    }
    let total: usize = all.iter().sum();
    println!("{profiles} profiles, {failed} not read, {total} keys");
    for (i, word) in ["mapped", "ignored", "lost", "unknown"].iter().enumerate()
    {
        let share = 100.0 * all[i] as f64 / total.max(1) as f64;
        println!("{word}: {} ({share:.1} %)", all[i]);
    }
    let matter = total - all[1];
    let share = 100.0 * all[0] as f64 / matter.max(1) as f64;
    println!("of those that matter, mapped: {share:.2} %");
    for (i, word) in [(2, "lost"), (3, "unknown")] {
        let mut keys: Vec<_> = names[i].iter().collect();
        keys.sort_by_key(|(_, n)| std::cmp::Reverse(**n));
        println!("{word}: {:?}", &keys[..keys.len().min(40)]);
    }
}
