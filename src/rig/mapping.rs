//! Which node is which bone: asks the override file, the VRM extension, the name tables, name tokens and the geometry, in
//! that order, and takes the first whole answer whose limbs hang together.

use super::bind::Skin;
use super::nodes::is_under;
use super::{Document, RigError, RigNode, geometry, names, overrides, space, vrm};
use crate::model::Role;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// Names of nodes shown where bones are missing.
const NAMES_SHOWN: usize = 40;

/// A humanoid that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// As [`super::Mapping::method`].
    pub method: String,
    /// 0..1, of the bones alone.
    pub confidence: f64,
    /// Role to node.
    pub bones: BTreeMap<Role, usize>,
    /// Required bones that the convention has none for.
    pub without: Vec<Role>,
    /// Left and right come from the file, not from a guess.
    pub sides_known: bool,
    /// Sentences.
    pub warnings: Vec<String>,
}

/// Finds the bones of the file `name`.
pub fn find(
    name: &str,
    document: &Document,
    nodes: &[RigNode],
    skins: &[Skin],
    bind: &[DAffine3],
    override_text: Option<&str>,
) -> Result<Found, RigError> {
    let positions: Vec<DVec3> = bind.iter().map(|global| global.translation).collect();
    let beside = overrides::file_name(name);
    let spoken = override_text.map_or(Ok(BTreeMap::new()), |text| overrides::read(&beside, text, nodes))?;
    let given: Vec<Role> = spoken.iter().filter(|(_, node)| node.is_some()).map(|(role, _)| *role).collect();
    let mut warnings = Vec::new();
    let declared = vrm::declared(document).map_err(|fault| fault.in_file(name))?;
    let mut answers: Vec<Found> = Vec::new();
    if let Some(declared) = declared {
        warnings.extend(declared.warnings);
        answers.push(Found {
            method: declared.method.into(),
            confidence: 1.0,
            bones: declared.bones,
            without: Vec::new(),
            sides_known: true,
            warnings: Vec::new(),
        });
    }
    let rank = rank(nodes, skins);
    if let Some(found) = names::match_tables(nodes, &rank, &given) {
        let notes: Vec<String> = found
            .without
            .iter()
            .map(|role| format!("{} rigs have no {} bone: its place is assumed", found.table, role.name()))
            .collect();
        answers.push(Found {
            method: format!("names: {}", found.table),
            confidence: if notes.is_empty() { 0.97 } else { 0.75 },
            bones: found.bones,
            without: found.without,
            sides_known: true,
            warnings: notes,
        });
    }
    let mut refusal: Option<String> = None;
    match geometry::guess(document, nodes, skins, &positions) {
        Ok(bones) => answers.push(by_geometry(bones, nodes)),
        Err(why) => refusal = why.filter(|_| answers.is_empty()),
    }
    answers.push(Found {
        method: "override".into(),
        confidence: 1.0,
        bones: BTreeMap::new(),
        without: Vec::new(),
        sides_known: true,
        warnings: Vec::new(),
    });
    let mut fewest: Option<Vec<Role>> = None;
    let mut unhinged: Option<String> = None; // every bone is there by its name, but they do not hang together
    for mut answer in answers {
        speak(&mut answer, &spoken);
        let missing = missing(&answer);
        if !missing.is_empty() {
            if fewest.as_ref().is_none_or(|fewest| missing.len() < fewest.len()) {
                fewest = Some(missing);
            }
            continue;
        }
        if let Some(broken) = broken_limb(nodes, &answer.bones) {
            if answer.method.starts_with("names") {
                let reason = format!("{} was not believed: {broken}", answer.method);
                unhinged = unhinged.or_else(|| Some(reason.clone()));
                warnings.push(reason);
                continue;
            }
            answer.warnings.push(broken);
            answer.confidence *= 0.8;
        }
        if let Some(reason) = space::not_human(&answer.bones, &positions) {
            let insisted = Role::REQUIRED.iter().all(|role| given.contains(role)) || answer.method.starts_with("vrm");
            if !insisted {
                refusal = refusal.or(Some(reason));
                continue;
            }
            answer.warnings.push(reason);
            answer.confidence *= 0.5;
        }
        answer.warnings.splice(0..0, warnings);
        return Ok(answer);
    }
    match refusal.or(unhinged) {
        Some(reason) => Err(RigError::NotHumanoid { file: name.into(), reason, overrides: beside }),
        None => Err(RigError::MissingBones {
            file: name.into(),
            missing: names::nearest(nodes, &rank, &given)
                .filter(|nearest| fewest.as_ref().is_none_or(|fewest| nearest.len() <= fewest.len()))
                .or(fewest)
                .unwrap_or_default(),
            seen: seen(nodes),
            overrides: beside,
        }),
    }
}

/// What the geometry found; its guess of the sides gives way to names that tell them.
fn by_geometry(bones: BTreeMap<Role, usize>, nodes: &[RigNode]) -> Found {
    let (mut right, mut wrong) = (0, 0);
    for (role, node) in bones.iter().filter(|(role, _)| role.mirrored() != **role) {
        let told = names::side_of(nodes[*node].name.as_deref().unwrap_or(""));
        let guessed = if role.name().starts_with("left") { 1 } else { -1 };
        right += usize::from(told == guessed);
        wrong += usize::from(told == -guessed);
    }
    let sides_known = right.max(wrong) >= 6 && right.min(wrong) == 0;
    let swap = sides_known && wrong > 0;
    Found {
        method: if sides_known { "geometry, sides by name".into() } else { "geometry".into() },
        confidence: if sides_known { 0.8 } else { 0.7 },
        bones: bones.into_iter().map(|(role, node)| (if swap { role.mirrored() } else { role }, node)).collect(),
        without: Vec::new(),
        sides_known,
        warnings: Vec::new(),
    }
}

/// Puts a person's word over the answer.
fn speak(answer: &mut Found, spoken: &BTreeMap<Role, Option<usize>>) {
    for (role, node) in spoken {
        answer.bones.remove(role);
        if let Some(node) = node {
            answer.bones.retain(|_, other| other != node);
        }
    }
    answer.bones.extend(spoken.iter().filter_map(|(role, node)| Some((*role, (*node)?))));
    if !spoken.is_empty() && answer.method != "override" {
        answer.method.push_str(" + override");
    }
}

/// Required bones that the answer lacks, but for those that its convention never has.
fn missing(answer: &Found) -> Vec<Role> {
    let had = |role: &Role| answer.bones.contains_key(role) || answer.without.contains(role);
    Role::REQUIRED.into_iter().filter(|role| !had(role)).collect()
}

/// A limb whose bones do not hang on one another.
fn broken_limb(nodes: &[RigNode], bones: &BTreeMap<Role, usize>) -> Option<String> {
    use Role::*;
    let limbs = [
        [LeftUpperArm, LeftLowerArm, LeftHand],
        [RightUpperArm, RightLowerArm, RightHand],
        [LeftUpperLeg, LeftLowerLeg, LeftFoot],
        [RightUpperLeg, RightLowerLeg, RightFoot],
    ];
    for limb in limbs {
        for pair in limb.windows(2) {
            let (Some(upper), Some(lower)) = (bones.get(&pair[0]), bones.get(&pair[1])) else { continue };
            if upper == lower || !is_under(nodes, *lower, *upper) {
                return Some(format!("{} does not hang on {}", pair[1].name(), pair[0].name()));
            }
        }
    }
    None
}

/// Of nodes with the same name a joint of a skin counts most, then one with children, then one that draws nothing.
fn rank(nodes: &[RigNode], skins: &[Skin]) -> Vec<u8> {
    let alone = |node: &RigNode| u8::from(!node.children.is_empty()) * 2 + u8::from(node.mesh.is_none());
    let mut rank: Vec<u8> = nodes.iter().map(alone).collect();
    skins.iter().flat_map(|skin| &skin.joints).for_each(|joint| rank[*joint] |= 4);
    rank
}

fn seen(nodes: &[RigNode]) -> String {
    let names: Vec<&str> = nodes.iter().filter_map(|node| node.name.as_deref()).collect();
    if names.is_empty() {
        return format!("{} nodes, none of them named", nodes.len());
    }
    let shown: Vec<String> = names.iter().take(NAMES_SHOWN).map(|name| name.chars().take(40).collect()).collect();
    let more = names.len().saturating_sub(NAMES_SHOWN);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &tail
}
