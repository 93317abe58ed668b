//! Facts about the machine that times depend on.

use serde::{Deserialize, Serialize};

use super::digest::digest;

/// What ran.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Machine {
    /// Its name.
    pub host: String,
    /// Model of the processor.
    pub cpu: String,
    /// Cores that the program may use.
    pub cores: usize,
    /// Runs at the same time.
    pub jobs: usize,
    /// Short name of the program's bytes: another one is another build.
    pub build: String,
}

impl Machine {
    /// This machine; what it does not tell is `unknown`.
    pub fn this(jobs: usize) -> Self {
        let unknown = || "unknown".to_owned();
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let host = read("/proc/sys/kernel/hostname").map(|name| name.trim().to_owned());
        let cpu = read("/proc/cpuinfo").and_then(|text| cpu_model(&text));
        let program = std::env::current_exe().ok().and_then(|path| std::fs::read(path).ok());
        Self {
            host: host.filter(|name| !name.is_empty()).unwrap_or_else(unknown),
            cpu: cpu.unwrap_or_else(unknown),
            cores: cores(),
            jobs,
            build: program.map_or_else(unknown, |bytes| digest(&bytes)),
        }
    }
}

/// How many threads the machine runs at the same time, at least 1.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

fn cpu_model(text: &str) -> Option<String> {
    let model = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name));
    model.map(|name| name.split_whitespace().collect::<Vec<_>>().join(" ")).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_read_from_the_list() {
        let text = "processor\t: 0\nmodel name\t: Some  CPU @ 2.0GHz\nflags\t: a b\n";
        assert_eq!(cpu_model(text).unwrap(), "Some CPU @ 2.0GHz");
        assert_eq!(cpu_model("processor: 0\n"), None);
    }
}
