//! Traces for the report.

use serde::{Deserialize, Serialize};

use super::FaultName;

/// Traces of one run for the pictures of the report: one value a sample, from sample 0.
/// A value that is not finite was not computed (the run-up of a band).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pictures {
    /// The fault; none for a healthy run.
    pub fault: Option<FaultName>,
    /// Control signal, V.
    #[serde(with = "trace")]
    pub c_m: Vec<f64>,
    /// Tachometer signal.
    #[serde(with = "trace")]
    pub t: Vec<f64>,
    /// Residual r = T - y_m.
    #[serde(with = "trace")]
    pub residual: Vec<f64>,
    /// Lower adaptive band on the residual.
    #[serde(with = "trace")]
    pub lower: Vec<f64>,
    /// Upper adaptive band on the residual.
    #[serde(with = "trace")]
    pub upper: Vec<f64>,
    /// Sample at which model error modelling declared the fault.
    pub declared: Option<usize>,
}

/// A trace in a file: its values as one text, to six digits; `-` for what was not computed. As a list of
/// numbers it would be many times as long.
mod trace {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        let text = |value: &f64| {
            if !value.is_finite() {
                return "-".to_owned();
            }
            let short: f64 = format!("{value:.5e}").parse().unwrap_or(*value);
            short.to_string()
        };
        to.serialize_str(&values.iter().map(text).collect::<Vec<_>>().join(" "))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(from)?;
        let value = |word: &str| match word {
            "-" => Ok(f64::NAN),
            word => word.parse().map_err(|_| D::Error::custom(format!("`{word}` is no number"))),
        };
        text.split_whitespace().map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traces_come_back_to_six_digits() {
        let pictures = Pictures {
            fault: None,
            c_m: vec![1.0, -2.345_678_9, 0.0],
            t: vec![2000.0, 1e-12, 123_456.789],
            residual: vec![f64::NAN, 0.5, -0.5],
            lower: Vec::new(),
            upper: vec![f64::INFINITY],
            declared: Some(7),
        };
        let text = serde_json::to_string(&pictures).expect("it is data");
        assert!(text.contains("1 -2.34568 0") && text.contains("- 0.5 -0.5"), "{text}");
        let back: Pictures = serde_json::from_str(&text).expect("it is one");
        assert_eq!((back.t, back.declared), (vec![2000.0, 1e-12, 123_457.0], Some(7)));
        assert!(back.residual[0].is_nan() && back.upper[0].is_nan() && back.lower.is_empty());
    }
}
