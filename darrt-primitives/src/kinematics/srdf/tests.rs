use super::*;

const URDF: &str = include_str!("../../../tests/data/generic_arm.urdf");

fn robot() -> RobotDescription {
    RobotDescription::from_text(URDF).unwrap()
}

fn read(body: &str) -> Result<SemanticDescription, SrdfError> {
    SemanticDescription::from_text(&format!("<robot name='generic_arm'>\n{body}\n</robot>"), &robot())
}

fn said(body: &str) -> String {
    read(body).unwrap_err().to_string()
}

const WHOLE: &str = "<virtual_joint name='world' type='planar' parent_frame='odom' child_link='mount'/>
<group name='all'><group name='arm'/><group name='hand'/><joint name='world'/></group>
<group name='arm'><chain base_link='mount' tip_link='hand'/></group>
<group name='hand'><link name='probe'/></group>
<group_state name='up' group='arm'><joint name='bend' value='0.5'/><joint name='world' value='1 2 3'/></group_state>
<end_effector name='tool' parent_link='hand' group='hand' parent_group='arm'/>
<passive_joint name='tilt'/><passive_joint name='world_joint'/>
<disable_collisions link1='mount' link2='rail' reason='Adjacent'/>
<disable_collisions link1='mount' link2='camera' reason='Never'/>
<disable_default_collisions link='probe'/><enable_collisions link1='probe' link2='rail'/>
<disable_collision link1='mount' link2='rail'/>
<rotor_params a='1'/>";

#[test]
fn everything_is_read_and_resolved() {
    let robot = robot();
    let read = read(WHOLE).unwrap();
    let names = |joints: &[usize]| joints.iter().map(|j| &*robot.joints[*j].name).collect::<Vec<_>>().join(" ");
    let link = |name: &str| robot.links.iter().position(|l| &*l.name == name).unwrap();
    let arm = read.group("arm").unwrap();
    assert_eq!(names(&arm.joints), "rail turn raise bend roll tilt twist");
    assert_eq!(arm.chains, [(link("mount"), link("hand"))]);
    assert_eq!(names(&read.group("hand").unwrap().joints), "follow");
    let all = read.group("all").unwrap();
    assert_eq!((names(&all.joints).as_str(), all.links.len()), ("rail turn raise bend roll tilt twist follow", 9));
    assert_eq!(all.virtual_joints, [0]);
    assert_eq!(read.virtual_joints[0].kind, VirtualKind::Planar);
    assert_eq!(read.states[0].joints[1], (AnyJoint::Virtual(0), vec![1.0, 2.0, 3.0]));
    assert_eq!(read.end_effectors[0].parent_group, Some(1));
    assert_eq!(names(&read.passive_joints), "tilt");
    assert!(read.is_disabled(link("rail"), link("mount")));
    assert!(!read.is_disabled(link("rail"), link("upper")));
    assert!(read.is_disabled(link("probe"), link("upper")) && !read.is_disabled(link("rail"), link("probe")));
    let remarks: Vec<String> = read.remarks.iter().map(|r| format!("{}: {}", r.line, r.text)).collect();
    assert_eq!(
        remarks,
        [
            "8: <passive_joint> names the joint \"world_joint\", which the robot does not have",
            "10: <disable_collisions> names the link \"camera\", which the robot does not have",
            "12: <disable_collision> is not read; did you mean <disable_collisions>?",
            "13: <rotor_params> is not read",
        ]
    );
}

#[test]
fn errors_name_element_and_line() {
    let cases = [
        ("<group/>", "line 2: <group> has no `name`"),
        (
            "<group name='a'>\n<link name='hnad'/></group>",
            "line 3: <link> names the link \"hnad\", which does not exist, did you mean \"hand\"?",
        ),
        ("<group name='a'/>\n<group name='a'/>", "line 3: <group> \"a\" has the name of another"),
        (
            "<group name='a'><chain base_link='hand' tip_link='rail'/></group>",
            "line 2: <chain>: link \"hand\" is not above link \"rail\"",
        ),
        (
            "<group name='a'><group name='b'/></group>\n<group name='b'><group name='a'/></group>",
            "line 2: group \"a\" holds itself, directly or through others",
        ),
        (
            "<group name='a'/><group_state name='s' group='a'><joint name='bend' value='nan'/></group_state>",
            "line 2: <joint>: `value` is \"nan\"; it must be 1 finite number",
        ),
        (
            "<virtual_joint name='v' type='flat' parent_frame='w' child_link='mount'/>",
            "line 2: <virtual_joint>: `type` is \"flat\"; it must be fixed, planar or floating",
        ),
        (
            "<group name='a'/><group_state name='s' group='a'><joint name='bend' value='1 2'/></group_state>",
            "line 2: <joint>: `value` is \"1 2\"; it must be 1 finite number",
        ),
        ("<virtual_joint name='bend' type='fixed'/>", "line 2: <virtual_joint> \"bend\" has the name of another"),
        (
            "<end_effector name='e' parent_link='hand' group='hands'/>",
            "line 2: <end_effector> names the group \"hands\", which does not exist",
        ),
    ];
    for (body, expected) in cases {
        assert_eq!(said(body), expected);
    }
}

#[test]
fn a_joint_of_another_variant_is_a_remark_in_a_group_too() {
    let text = "<robot name='generic_arm'><group name='a'><joint name='trun'/><joint name='bend'/></group></robot>";
    let read = SemanticDescription::from_text(text, &robot()).unwrap();
    assert_eq!(read.groups[0].joints.len(), 1);
    let said = "<joint> names the joint \"trun\", which the robot does not have; did you mean \"turn\"?";
    assert_eq!(read.remarks[0].text, said);
}

#[test]
fn what_is_no_srdf_is_refused() {
    let robot = robot();
    let read = |text: &str| SemanticDescription::from_text(text, &robot).map_err(|error| error.to_string());
    assert_eq!(read("<sdf/>").unwrap_err(), "not a semantic description: its root is <sdf>, not <robot>");
    assert!(read("<!DOCTYPE robot><robot/>").is_err() && read("<robot>").is_err() && read("").is_err());
    let other = read("<robot name='other'/>").unwrap();
    assert_eq!(other.remarks[0].text, "the robot is called \"other\" here and \"generic_arm\" in its URDF");
    assert!(SemanticDescription::from_file(Path::new("/no/such.srdf"), &robot).is_err());
}
