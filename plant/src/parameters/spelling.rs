//! What was meant by a name that is not known.

/// The question after an unknown name.
pub(crate) fn meant(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// The known name that is spelt most like the given one, if one is near.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    // A third of the letters may be wrong, and R and r are the same slip of a key.
    let most = (name.chars().count() / 3).max(1);
    let lower = name.to_lowercase();
    let distance = |other: &str| strsim::damerau_levenshtein(&lower, &other.to_lowercase());
    known
        .map(|other| (distance(other), other))
        .filter(|(d, _)| *d <= most)
        .min()
        .map(|(_, other)| other.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_a_key_finds_its_name() {
        let known = ["R", "K_e", "K_m", "coulomb"];
        let found = |name| nearest(name, known.into_iter());
        assert_eq!(found("r").as_deref(), Some("R"));
        assert_eq!(found("Coulmob").as_deref(), Some("coulomb"));
        assert_eq!(found("k_M").as_deref(), Some("K_m"));
        assert_eq!(found("viscous"), None);
    }
}
