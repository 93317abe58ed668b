//! Options of `darrt robot`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Options of `darrt robot`.
#[derive(Debug, Args)]
pub struct RobotOptions {
    /// What to do.
    #[command(subcommand)]
    pub command: RobotCommand,
}

/// What `darrt robot` does.
#[derive(Debug, Subcommand)]
pub enum RobotCommand {
    /// List the robots inside, or print one's robot file or description to copy and edit
    List(RobotListOptions),
    /// Read a robot file as planning would, try the robot, draw it, and say what is odd
    Check(RobotCheckOptions),
    /// Write a first robot file for a description (URDF), with guesses to look at
    New(RobotNewOptions),
}

/// Options of `darrt robot list`.
#[derive(Debug, Args)]
pub struct RobotListOptions {
    /// Print the robot file of this robot
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,
    /// Print the description of this robot
    #[arg(long, value_name = "NAME", conflicts_with = "print")]
    pub print_urdf: Option<String>,
}

/// Options of `darrt robot check`.
#[derive(Debug, Args)]
pub struct RobotCheckOptions {
    /// A robot file, or a name of `darrt robot list`
    #[arg(value_name = "FILE|NAME")]
    pub robot: String,
    /// Write a first problem for it here
    #[arg(long, value_name = "FILE")]
    pub problem: Option<PathBuf>,
    /// Draw it here: .html (3-D), .svg, .png or .glb [default: NAME.robot.html in the current folder]
    #[arg(long, value_name = "FILE", conflicts_with = "no_picture")]
    pub picture: Option<PathBuf>,
    /// Draw no picture
    #[arg(long)]
    pub no_picture: bool,
    /// Say of every pair of links whether it is checked, and why
    #[arg(long)]
    pub pairs: bool,
}

/// Options of `darrt robot new`.
#[derive(Debug, Args)]
pub struct RobotNewOptions {
    /// The description
    #[arg(value_name = "URDF")]
    pub urdf: PathBuf,
    /// Write the robot file here [default: beside the description, .toml]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Where a package is that meshes are in, once for each [default: looked for by `ROS_PACKAGE_PATH`, `AMENT_PREFIX_PATH`
    /// and in the folders above the description]
    #[arg(long, value_name = "NAME=FOLDER", value_parser = package)]
    pub package: Vec<(String, PathBuf)>,
}

/// A package and its folder.
fn package(text: &str) -> Result<(String, PathBuf), String> {
    let (name, folder) = text.split_once('=').ok_or("must be the name of a package, `=`, and its folder")?;
    let path = PathBuf::from(folder);
    if name.is_empty() || !path.is_dir() {
        return Err(format!("there is no folder `{folder}` for the package `{name}`"));
    }
    Ok((name.to_owned(), path))
}
