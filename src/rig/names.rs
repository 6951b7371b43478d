//! Bone names by convention: the tables of `rigs/names/` against the node names of a file.
//!
//! Names are compared as lower-case letters and digits (`thigh.l` = `thigh_l` = `thighl`, as three.js leaves them), with
//! namespaces (`hero:`, `Armature|`), an affix that most nodes share (`_Armature`) and Sketchfab's trailing numbers
//! taken off if that helps. A table counts only if it has all the required bones; partial names are `tokens`' business.

use super::RigNode;
use crate::model::Role;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The tables, most common first: on a tie the earlier wins.
const TABLES: [&str; 14] = [
    include_str!("../../rigs/names/01_mixamo.toml"),
    include_str!("../../rigs/names/02_unreal.toml"),
    include_str!("../../rigs/names/03_rigify.toml"),
    include_str!("../../rigs/names/04_biped.toml"),
    include_str!("../../rigs/names/05_cc.toml"),
    include_str!("../../rigs/names/06_daz.toml"),
    include_str!("../../rigs/names/08_kaykit.toml"),
    include_str!("../../rigs/names/07_vrm.toml"),
    include_str!("../../rigs/names/09_biovision.toml"),
    include_str!("../../rigs/names/10_smpl.toml"),
    include_str!("../../rigs/names/11_cmu.toml"),
    include_str!("../../rigs/names/12_opensim.toml"),
    include_str!("../../rigs/names/13_makehuman.toml"),
    include_str!("../../rigs/names/14_plain.toml"),
];

/// The tables, read once: a folder of clips asks for them thousands of times.
static READ: LazyLock<Vec<Table>> = LazyLock::new(|| {
    let read = |text: &&str| toml::from_str(text).expect("the tables in rigs/names are read by a test");
    TABLES.iter().map(read).collect()
});

/// What a table found.
#[derive(Clone, Debug, PartialEq)]
pub struct NameMatch {
    /// The convention.
    pub table: String,
    /// Role to node.
    pub bones: BTreeMap<Role, usize>,
    /// Required roles that this convention has no bone for.
    pub without: Vec<Role>,
}

/// A table as its file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    /// Left and right as they stand for `{s}`.
    sides: [String; 2],
    #[serde(default)]
    other_sides: Vec<[String; 2]>,
    /// Tried in order; "" is no prefix.
    prefixes: Vec<String>,
    /// The bones between hips and neck, from below.
    spines: Vec<String>,
    /// Required roles that the convention lacks.
    #[serde(default)]
    without: Vec<String>,
    /// Role (without its side if it has one) to names, best first.
    bones: BTreeMap<String, Vec<String>>,
}

/// The best match among all tables that have every required bone. `rank`: of nodes with one name the highest is taken.
/// Roles of `given` need not be found: a person has named them.
pub fn match_tables(nodes: &[RigNode], rank: &[u8], given: &[Role]) -> Option<NameMatch> {
    let whole = tries(nodes, rank).into_iter().filter(|found| lacking(found, given).is_empty());
    // Of equals the earlier table.
    whole.reduce(|best, found| if found.bones.len() > best.bones.len() { found } else { best })
}

/// The required bones that the nearest table does not find, where it finds some.
pub fn nearest(nodes: &[RigNode], rank: &[u8], given: &[Role]) -> Option<Vec<Role>> {
    tries(nodes, rank).iter().map(|found| lacking(found, given)).min_by_key(Vec::len)
}

fn lacking(found: &NameMatch, given: &[Role]) -> Vec<Role> {
    let known = |role: &Role| found.bones.contains_key(role) || found.without.contains(role) || given.contains(role);
    Role::REQUIRED.into_iter().filter(|role| !known(role)).collect()
}

/// What each table finds under each reading of the names; hips at least.
fn tries(nodes: &[RigNode], rank: &[u8]) -> Vec<NameMatch> {
    let schemes = schemes(nodes, rank);
    let mut found = Vec::new();
    for table in READ.iter() {
        for index in &schemes {
            for prefix in &table.prefixes {
                for sides in std::iter::once(&table.sides).chain(&table.other_sides) {
                    found.extend(try_table(table, &canonical(prefix), sides, index, nodes));
                }
            }
        }
    }
    found
}

/// Gives the bones between hips and neck (from below) their roles: the first is the spine, the last the upper chest.
pub fn assign_spine(bones: &mut BTreeMap<Role, usize>, chain: &[usize]) {
    let roles: &[(Role, usize)] = match chain.len() {
        0 => &[],
        1 => &[(Role::Spine, 0)],
        2 => &[(Role::Spine, 0), (Role::Chest, 1)],
        count => &[(Role::Spine, 0), (Role::Chest, count / 2), (Role::UpperChest, count - 1)],
    };
    bones.extend(roles.iter().map(|(role, at)| (*role, chain[*at])));
}

/// Lower-case letters and digits only.
pub fn canonical(name: &str) -> String {
    name.chars().filter(|letter| letter.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The side that a name tells: `+1` left, `-1` right, from `L`, `left`, `r_`, `.R` as words of their own.
pub fn side_of(name: &str) -> i32 {
    let mut words: Vec<String> = vec![String::new()];
    let mut lower = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || (letter.is_uppercase() && lower) {
            words.push(String::new());
        }
        lower = letter.is_lowercase();
        if letter.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
    }
    let counts = |side: [&str; 2]| words.iter().filter(|word| side.contains(&word.as_str())).count() as i32;
    (counts(["l", "left"]) - counts(["r", "right"])).signum()
}

fn try_table(
    table: &Table,
    prefix: &str,
    sides: &[String; 2],
    index: &BTreeMap<String, usize>,
    nodes: &[RigNode],
) -> Option<NameMatch> {
    let find = |name: &str| index.get(&format!("{prefix}{}", canonical(name))).copied();
    let mut bones = BTreeMap::new();
    for (key, names) in &table.bones {
        if let Some(role) = Role::from_name(key) {
            if let Some(node) = names.iter().find_map(|name| find(name)) {
                bones.insert(role, node);
            }
            continue;
        }
        for (side, word) in ["left", "right"].iter().zip(sides) {
            let role = Role::from_name(&format!("{side}{key}")).expect("the tables in rigs/names are read by a test");
            if let Some(node) = names.iter().find_map(|name| find(&name.replace("{s}", word))) {
                bones.insert(role, node);
            }
        }
    }
    let hips = *bones.get(&Role::Hips)?;
    let mut chain: Vec<usize> = Vec::new();
    for node in table.spines.iter().filter_map(|name| find(name)) {
        if node != hips && !chain.contains(&node) && super::nodes::is_under(nodes, node, hips) {
            chain.push(node);
        }
    }
    let depth = |node: usize| super::nodes::depth(nodes, node);
    chain.sort_by_key(|node| depth(*node));
    assign_spine(&mut bones, &chain);
    let without: Vec<Role> = table.without.iter().filter_map(|name| Role::from_name(name)).collect();
    let without: Vec<Role> = without.into_iter().filter(|role| !bones.contains_key(role)).collect();
    // One node cannot be two bones; of two roles the first in the body's order keeps it.
    let mut taken = Vec::new();
    bones.retain(|_, node| {
        let free = !taken.contains(node);
        taken.push(*node);
        free
    });
    Some(NameMatch { table: table.name.clone(), bones, without })
}

/// Ways to read the names of a file: each maps canonical names to nodes.
fn schemes(nodes: &[RigNode], rank: &[u8]) -> Vec<BTreeMap<String, usize>> {
    let plain = |name: &str| name.to_owned();
    let bare = |name: &str| name.rsplit([':', '|']).next().unwrap_or(name).to_owned();
    let names: Vec<&str> = nodes.iter().filter_map(|node| node.name.as_deref()).collect();
    let (prefix, suffix) = (common_prefix(&names), common_suffix(&names));
    let cut = |name: &str| {
        let name = name.strip_prefix(prefix.as_str()).unwrap_or(name);
        name.strip_suffix(suffix.as_str()).unwrap_or(name).to_owned()
    };
    let unnumbered = |name: &str| {
        let bare = bare(name);
        match bare.rsplit_once('_') {
            Some((head, tail)) if !tail.is_empty() && tail.bytes().all(|byte| byte.is_ascii_digit()) => head.to_owned(),
            _ => bare,
        }
    };
    let both = |name: &str| unnumbered(&cut(name));
    let readings: [&dyn Fn(&str) -> String; 5] = [&plain, &bare, &cut, &unnumbered, &both];
    let mut schemes: Vec<BTreeMap<String, usize>> = Vec::new();
    for read in readings {
        let mut index: BTreeMap<String, usize> = BTreeMap::new();
        for (at, node) in nodes.iter().enumerate() {
            let Some(name) = &node.name else { continue };
            let slot = index.entry(canonical(&read(name))).or_insert(at);
            if rank[at] > rank[*slot] {
                *slot = at;
            }
        }
        if !schemes.contains(&index) {
            schemes.push(index);
        }
    }
    schemes
}

/// A prefix up to a separator that most names have.
fn common_prefix(names: &[&str]) -> String {
    let heads = names.iter().filter_map(|name| name.find([':', '|', '_', '-', ' ', '.']).map(|at| &name[..=at]));
    frequent(heads, names.len())
}

/// A suffix from a separator that most names have.
fn common_suffix(names: &[&str]) -> String {
    let tails = names.iter().filter_map(|name| name.rfind(['_', '-', ' ', '.']).map(|at| &name[at..]));
    frequent(tails, names.len())
}

fn frequent<'a>(parts: impl Iterator<Item = &'a str>, of: usize) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    parts.for_each(|part| *counts.entry(part).or_default() += 1);
    let most = counts.into_iter().max_by_key(|(_, count)| *count);
    most.filter(|(_, count)| count * 10 >= of * 6).map_or(String::new(), |(part, _)| part.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_reads_and_names_real_roles() {
        for text in TABLES {
            let table: Table = toml::from_str(text).expect("a table of rigs/names");
            for key in table.bones.keys() {
                let known = Role::from_name(key).or_else(|| Role::from_name(&format!("left{key}")));
                assert!(known.is_some(), "{}: {key} is no role", table.name);
            }
            let sided = |role: &Role| {
                table.bones.contains_key(role.name().trim_start_matches("left").trim_start_matches("right"))
            };
            for role in Role::REQUIRED {
                let named = table.bones.contains_key(role.name()) || sided(&role) || role == Role::Spine;
                assert!(named, "{}: {} has no names", table.name, role.name());
            }
            assert!(table.without.iter().all(|name| Role::from_name(name).is_some()), "{}: without", table.name);
        }
    }

    #[test]
    fn sides_are_read_from_words_and_not_from_letters() {
        for (name, side) in [
            ("thigh.l", 1),
            ("LeftArm", 1),
            ("arm_upper.R", -1),
            ("Bip01 R Foot", -1),
            ("lThigh", 1),
            ("rollBone", 0),
            ("Leftover", 0),
            ("spine", 0),
        ] {
            assert_eq!(side_of(name), side, "{name}");
        }
    }

    #[test]
    fn affixes_of_most_names_are_found_and_sides_are_not_taken_for_one() {
        let names = ["hips_Armature", "thigh.l_Armature", "thigh.r_Armature", "Body"];
        assert_eq!(common_suffix(&names), "_Armature", "three of four end so");
        assert_eq!(common_suffix(&["thigh_l", "calf_l", "thigh_r", "calf_r"]), "", "half of them is no common suffix");
    }
}
