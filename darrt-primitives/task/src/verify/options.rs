//! How finely a plan is replayed and how much it may be off.

/// Resolution and tolerances of the verifier. All must be finite and not negative; the two steps must be positive.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifyOptions {
    /// No point of the robot or of what it moves travels farther between two checked states, metres, >= 1e-5.
    pub travel_m: f64,
    /// No joint turns farther between two checked states, radians, >= 1e-4.
    pub joint_rad: f64,
    /// How far a standing object may be from its surface, and how deep it may press into what carries it, metres.
    pub support_m: f64,
    /// How far a standing or pushed object may lean, radians.
    pub upright_rad: f64,
    /// How far a held object may be from where the hand has it, metres.
    pub rigid_m: f64,
    /// How far a held object may be turned from how the hand has it, radians.
    pub rigid_rad: f64,
    /// How far a held object may be from either fingertip, metres.
    pub grip_m: f64,
    /// How far a fingertip may be from the rim that it pushes, or inside it, metres.
    pub push_contact_m: f64,
    /// Angle between the way of a pushed object and the ray from the middle of the contacts through its centre, radians.
    pub push_ray_rad: f64,
    /// How far the tool may be beside the line of a straight-line primitive, metres.
    pub line_m: f64,
    /// How far the tool may turn in a straight-line primitive, radians.
    pub line_rad: f64,
    /// Slack of joint limits, bounds and start values: what rounding may do, metres or radians.
    pub rounding: f64,
    /// Look at every state and at every pair of solids exactly, and leave nothing out: some hundred times as much work, for
    /// the same verdict.
    pub is_plain: bool,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self {
            travel_m: 0.0025,
            joint_rad: 0.5_f64.to_radians(),
            support_m: 1e-3,
            upright_rad: 0.5_f64.to_radians(),
            rigid_m: 1e-6,
            rigid_rad: 1e-6,
            grip_m: 3e-3,
            push_contact_m: 2e-3,
            push_ray_rad: 1.0_f64.to_radians(),
            line_m: 5e-3,
            line_rad: 2.0_f64.to_radians(),
            rounding: 1e-9,
            is_plain: false,
        }
    }
}

impl VerifyOptions {
    /// The name and value of the first option out of range.
    pub(super) fn flaw(&self) -> Option<(&'static str, f64)> {
        let options = [
            ("travel_m", self.travel_m, 1e-5),
            ("joint_rad", self.joint_rad, 1e-4),
            ("support_m", self.support_m, 0.0),
            ("upright_rad", self.upright_rad, 0.0),
            ("rigid_m", self.rigid_m, 0.0),
            ("rigid_rad", self.rigid_rad, 0.0),
            ("grip_m", self.grip_m, 0.0),
            ("push_contact_m", self.push_contact_m, 0.0),
            ("push_ray_rad", self.push_ray_rad, 0.0),
            ("line_m", self.line_m, 0.0),
            ("line_rad", self.line_rad, 0.0),
            ("rounding", self.rounding, 0.0),
        ];
        let bad = |(_, value, least): &(&str, f64, f64)| !value.is_finite() || value < least;
        options.into_iter().find(bad).map(|(name, value, _)| (name, value))
    }
}
