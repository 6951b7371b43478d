//! Which node carries the travel, where nobody said so, and what the choice costs.
//!
//! A rig with a root bone carries it there, in every program. One without (Mixamo, VRM) gets a node `Root` over its skeleton, which a
//! character that is in a scene already has not: who plays the clip on that one, or in a program that binds by armature, wants the travel
//! in the hips.

use super::args::Root;
use crate::bake::root_motion::root_bone;
use crate::export::engine::Engine;
use crate::rig::Rig;

/// The node, and a sentence for the person where there is something to say.
pub fn chosen(
    rig: &Rig,
    wanted: Option<Root>,
    engines: &[&'static Engine],
    only_animation: bool,
) -> (Root, Option<String>) {
    if root_bone(rig).is_some() {
        return (wanted.unwrap_or(Root::Root), None);
    }
    let names = |hips: bool| {
        let titles: Vec<&str> =
            engines.iter().filter(|engine| engine.rootless_hips == hips).map(|engine| engine.title).collect();
        titles.join(" and ")
    };
    let lost = "the rig has no root bone: the travel is on a new node `Root`, which programs that bind a clip by armature leave out";
    match wanted {
        Some(Root::Root) if only_animation || engines.is_empty() => {
            (Root::Root, Some(format!("{lost} (--root hips keeps it in the skeleton)")))
        }
        Some(root) => (root, None),
        None if engines.is_empty() && !only_animation => {
            (Root::Root, Some(format!("{lost} (--root hips keeps it in the skeleton; --engine NAME chooses)")))
        }
        None if engines.is_empty() => {
            let why = "the rig has no root bone, and the character in the scene has none: the travel is in its hips (--root hips)";
            (Root::Hips, Some(why.into()))
        }
        None if engines.iter().all(|engine| engine.rootless_hips) => (
            Root::Hips,
            Some(format!("the rig has no root bone: for {} the travel is in its hips (--root hips)", names(true))),
        ),
        None => {
            let new = format!(
                "the rig has no root bone: for {} the travel is on a new bone `Root` (--root root)",
                names(false)
            );
            let other = match names(true) {
                titles if titles.is_empty() => String::new(),
                titles => format!("; for {titles} bake another with --root hips"),
            };
            (Root::Root, Some(new + &other))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::load_bytes;
    use crate::rig::mannequin::BUILTIN;

    fn rig(rooted: bool) -> Rig {
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let mut rig = load_bytes("builtin", BUILTIN, &alone, None).expect("it loads");
        let root = root_bone(&rig).expect("it has one");
        if !rooted {
            rig.nodes[root].name = Some("Armature".into());
            for skin in rig.document.json["skins"].as_array_mut().expect("skins") {
                skin["joints"].as_array_mut().expect("joints").retain(|joint| *joint != root);
            }
        }
        rig
    }

    fn engines(names: &[&str]) -> Vec<&'static Engine> {
        names.iter().map(|name| Engine::named(name).expect("known")).collect()
    }

    #[test]
    fn a_root_bone_carries_the_travel_everywhere() {
        for names in [&[][..], &["unity"], &["blender", "unreal"]] {
            assert_eq!(chosen(&rig(true), None, &engines(names), true), (Root::Root, None));
        }
    }

    #[test]
    fn without_one_the_engine_decides_and_the_person_is_asked_first() {
        let rootless = rig(false);
        for (names, only, wanted, root, says) in [
            (&[][..], false, None, Root::Root, "new node `Root`"),
            (&[], true, None, Root::Hips, "--root hips"),
            (&["unity"], false, None, Root::Hips, "Unity"),
            (&["blender"], false, None, Root::Root, "new bone `Root`"),
            (&["unity", "unreal"], false, None, Root::Root, "for Unity bake another"),
            (&[], false, Some(Root::Root), Root::Root, "leave out"),
        ] {
            let (got, said) = chosen(&rootless, wanted, &engines(names), only);
            assert_eq!(got, root, "{names:?} {only}");
            assert!(said.as_deref().is_some_and(|said| said.contains(says)), "{names:?} {only}: {said:?}");
        }
        assert_eq!(chosen(&rootless, Some(Root::InPlace), &engines(&["unity"]), false), (Root::InPlace, None));
    }
}
