//! Names that are known as a whole.

/// Whole names (folded and joined) whose parts would say something else or nothing.
pub(super) const WHOLE: &[(&[&str], &[&str])] = &[
    (&["t", "tsec", "xvalue"], &["time"]),
    (&["vir", "uin", "vin", "input", "control", "controlvoltage"], &["u"]),
    (&["qm"], &["x", "theta"]),
    (&["qg"], &["reference"]),
    (&["tl", "tload", "load"], &["T_l"]),
    (&["f", "fm"], &["torque"]),
    // One letter for two things: the unit tells.
    (&["v"], &["u", "v"]),
    (&["q"], &["x", "theta"]),
    (&["qd", "dq", "qdot", "dtheta", "thetadot"], &["omega", "v"]),
    (&["testid", "testnr", "testno", "testnumber"], &["segment"]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::exact;
    use crate::words::words;

    #[test]
    fn every_whole_name_is_listed_once_and_leads_somewhere() {
        let mut seen: Vec<&str> = Vec::new();
        for (names, targets) in WHOLE {
            for name in *names {
                assert_eq!(words(name).concat(), **name);
                assert!(!seen.contains(name), "`{name}` is listed twice");
                seen.push(name);
            }
            for target in *targets {
                assert!(exact(target).is_some(), "`{target}` is no canonical signal");
            }
        }
    }
}
