//! A value for each detector of the residual.

use std::collections::BTreeMap;

use drivescope_diagnoser::DetectorKind;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A value for each detector; in files under its name, in the order of the registry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByDetector<T = f64>([T; DetectorKind::ALL.len()]);

impl<T> ByDetector<T> {
    /// One value a detector.
    pub fn from_fn(value: impl FnMut(DetectorKind) -> T) -> Self {
        Self(DetectorKind::ALL.map(value))
    }

    /// The one of this detector.
    pub fn get(&self, kind: DetectorKind) -> &T {
        &self.0[kind as usize]
    }

    /// The one of this detector, to change.
    pub fn get_mut(&mut self, kind: DetectorKind) -> &mut T {
        &mut self.0[kind as usize]
    }
}

impl<T: Copy> ByDetector<T> {
    /// The one of this detector.
    pub fn of(&self, kind: DetectorKind) -> T {
        *self.get(kind)
    }
}

impl<T: Serialize> Serialize for ByDetector<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(DetectorKind::ALL.into_iter().zip(&self.0))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for ByDetector<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut given = BTreeMap::<DetectorKind, T>::deserialize(deserializer)?;
        if let Some(missing) = DetectorKind::ALL.into_iter().find(|kind| !given.contains_key(kind))
        {
            return Err(D::Error::missing_field(missing.id()));
        }
        Ok(Self::from_fn(|kind| given.remove(&kind).expect("each is there")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_under_their_names_and_each_must_be_there() {
        let counted = ByDetector::from_fn(|kind| kind as usize);
        let text = serde_json::to_string(&counted).unwrap();
        assert!(text.starts_with(r#"{"mem":0,"mem_recurrent":1,"constant":2,"gmdh":3"#), "{text}");
        assert_eq!(serde_json::from_str::<ByDetector<usize>>(&text).unwrap(), counted);
        let error = serde_json::from_str::<ByDetector>(r#"{"mem": 0.1}"#).unwrap_err();
        assert!(error.to_string().contains("mem_recurrent"), "{error}");
        assert!(serde_json::from_str::<ByDetector>(r#"{"no_such": 0.1}"#).is_err());
    }
}
