//! Humanoid bone roles, named as VRM 1.0 names them (Godot's and Unity's lists are the same bones).

/// Declares the roles once: variant, VRM 1.0 name.
macro_rules! roles {
    ($($variant:ident $name:literal),* $(,)?) => {
        /// A bone's part in a humanoid. The order is that of a walk through the body, parents first.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Role { $(#[doc = $name] $variant),* }

        impl Role {
            /// Every role, parents before children.
            pub const ALL: &'static [Role] = &[$(Role::$variant),*];

            /// The VRM 1.0 name, as in `leftUpperArm`.
            pub fn name(self) -> &'static str {
                match self { $(Role::$variant => $name),* }
            }
        }
    };
}

roles! {
    Hips "hips", Spine "spine", Chest "chest", UpperChest "upperChest", Neck "neck", Head "head",
    Jaw "jaw", LeftEye "leftEye", RightEye "rightEye",
    LeftShoulder "leftShoulder", LeftUpperArm "leftUpperArm", LeftLowerArm "leftLowerArm", LeftHand "leftHand",
    RightShoulder "rightShoulder", RightUpperArm "rightUpperArm", RightLowerArm "rightLowerArm", RightHand "rightHand",
    LeftUpperLeg "leftUpperLeg", LeftLowerLeg "leftLowerLeg", LeftFoot "leftFoot", LeftToes "leftToes",
    RightUpperLeg "rightUpperLeg", RightLowerLeg "rightLowerLeg", RightFoot "rightFoot", RightToes "rightToes",
    LeftThumbMetacarpal "leftThumbMetacarpal", LeftThumbProximal "leftThumbProximal", LeftThumbDistal "leftThumbDistal",
    LeftIndexProximal "leftIndexProximal", LeftIndexIntermediate "leftIndexIntermediate", LeftIndexDistal "leftIndexDistal",
    LeftMiddleProximal "leftMiddleProximal", LeftMiddleIntermediate "leftMiddleIntermediate", LeftMiddleDistal "leftMiddleDistal",
    LeftRingProximal "leftRingProximal", LeftRingIntermediate "leftRingIntermediate", LeftRingDistal "leftRingDistal",
    LeftLittleProximal "leftLittleProximal", LeftLittleIntermediate "leftLittleIntermediate", LeftLittleDistal "leftLittleDistal",
    RightThumbMetacarpal "rightThumbMetacarpal", RightThumbProximal "rightThumbProximal", RightThumbDistal "rightThumbDistal",
    RightIndexProximal "rightIndexProximal", RightIndexIntermediate "rightIndexIntermediate", RightIndexDistal "rightIndexDistal",
    RightMiddleProximal "rightMiddleProximal", RightMiddleIntermediate "rightMiddleIntermediate", RightMiddleDistal "rightMiddleDistal",
    RightRingProximal "rightRingProximal", RightRingIntermediate "rightRingIntermediate", RightRingDistal "rightRingDistal",
    RightLittleProximal "rightLittleProximal", RightLittleIntermediate "rightLittleIntermediate", RightLittleDistal "rightLittleDistal",
}

impl Role {
    /// The eleven a rig must have: without one of them there is no body to balance.
    pub const REQUIRED: [Role; 11] = [
        Role::Hips,
        Role::Spine,
        Role::Head,
        Role::LeftUpperArm,
        Role::LeftLowerArm,
        Role::RightUpperArm,
        Role::RightLowerArm,
        Role::LeftUpperLeg,
        Role::LeftLowerLeg,
        Role::RightUpperLeg,
        Role::RightLowerLeg,
    ];

    /// The role of that VRM 1.0 name, case as in the specification.
    pub fn from_name(name: &str) -> Option<Role> {
        Role::ALL.iter().copied().find(|role| role.name() == name)
    }

    /// The same bone of the other side; itself for the bones of the middle.
    pub fn mirrored(self) -> Role {
        let name = self.name();
        let other = if let Some(rest) = name.strip_prefix("left") {
            format!("right{rest}")
        } else if let Some(rest) = name.strip_prefix("right") {
            format!("left{rest}")
        } else {
            return self;
        };
        Role::from_name(&other).unwrap_or(self)
    }

    /// The role that this one hangs from in a full skeleton. Where a rig lacks it, go on upwards.
    pub fn parent(self) -> Option<Role> {
        use Role::*;
        Some(match self {
            Hips => return None,
            Spine => Hips,
            Chest => Spine,
            UpperChest => Chest,
            Neck | LeftShoulder | RightShoulder => UpperChest,
            Head => Neck,
            Jaw | LeftEye | RightEye => Head,
            LeftUpperArm => LeftShoulder,
            LeftLowerArm => LeftUpperArm,
            LeftHand => LeftLowerArm,
            RightUpperArm => RightShoulder,
            RightLowerArm => RightUpperArm,
            RightHand => RightLowerArm,
            LeftUpperLeg | RightUpperLeg => Hips,
            LeftLowerLeg => LeftUpperLeg,
            LeftFoot => LeftLowerLeg,
            LeftToes => LeftFoot,
            RightLowerLeg => RightUpperLeg,
            RightFoot => RightLowerLeg,
            RightToes => RightFoot,
            _ => {
                let name = self.name();
                let hand = if name.starts_with("left") { LeftHand } else { RightHand };
                if name.ends_with("Metacarpal") || (name.ends_with("Proximal") && !name.contains("Thumb")) {
                    hand
                } else {
                    // Within a finger the list runs from the palm outwards.
                    let at = Role::ALL.iter().position(|role| *role == self).unwrap_or(1);
                    Role::ALL[at - 1]
                }
            }
        })
    }
}
