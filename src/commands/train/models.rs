//! How the models of a training are asked for.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use drivescope_diagnoser::{
    BoundOptions, Design, ErrorModel, Method, Orders, Orthants, Recipe, Selection, Sets, Structure,
    Trained, Training, Uncertain,
};

use crate::failure::into_report;

/// Outer steps of the paper's random search, and its starts.
const OUTER: usize = 100;
const SEARCHES: usize = 1;

/// Sizes, orders and searches other than the usual.
#[derive(Debug, Clone, Args)]
pub(crate) struct Models {
    /// Sizes of the process model: `paper` (3 IIR, 6 FIR neurons, first order), `aic` for the smallest
    /// criterion of those among 16 that follow a healthy recording as well as the best, or V1,V2,ORDER.
    #[arg(long, value_name = "paper|aic|V1,V2,R", default_value = "paper")]
    structure: Sizes,
    /// Orders of the ARX error model: `free-run` for the least error in free run on data that are not
    /// fitted, `aic` for the smallest criterion of its one-step errors, or N_A,N_B.
    #[arg(long, value_name = "free-run|aic|N_A,N_B", default_value = "free-run")]
    orders: ErrorOrders,
    /// How networks are trained: Levenberg-Marquardt, or the paper's Adaptive Random Search, which is
    /// slow.
    #[arg(long, value_enum, default_value_t = Search::Lm)]
    search: Search,
    /// Whose parameters of the GMDH network are bounded: the output neuron's, or every neuron's, whose
    /// intervals then pass on as errors in the regressors (13) to (16).
    #[arg(long, value_enum, default_value_t = Bounded::Output)]
    uncertain: Bounded,
    /// Where parameters with uncertain regressors are looked for: the orthant of the least-squares
    /// estimate, on which intervals are then conditional, or all of them.
    #[arg(long, value_enum, default_value_t = Where::Estimate)]
    orthants: Where,
}

impl Default for Models {
    fn default() -> Self {
        Self {
            structure: Sizes::Paper,
            orders: ErrorOrders::FreeRun,
            search: Search::Lm,
            uncertain: Bounded::Output,
            orthants: Where::Estimate,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sizes {
    Paper,
    Aic,
    Given([usize; 3]),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ErrorOrders {
    FreeRun,
    Aic,
    Given([usize; 2]),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Search {
    Lm,
    Ars,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Bounded {
    Output,
    Every,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Where {
    Estimate,
    All,
}

/// N whole numbers, the last ones at least 1.
fn numbers<const N: usize>(text: &str, least: [usize; N]) -> Option<[usize; N]> {
    let read: Vec<usize> =
        text.split(',').map(|it| it.trim().parse().ok()).collect::<Option<_>>()?;
    let read: [usize; N] = read.try_into().ok()?;
    /// More is a slip of the finger.
    const MOST: usize = 200;
    let fits = read.iter().zip(least).all(|(n, least)| (least..=MOST).contains(n));
    fits.then_some(read)
}

impl FromStr for Sizes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "paper" => Ok(Self::Paper),
            "aic" => Ok(Self::Aic),
            _ => numbers(text, [1; 3]).map(Self::Given).ok_or_else(|| {
                "give paper, aic, or three numbers from 1 to 200, as in 3,6,1".to_owned()
            }),
        }
    }
}

impl FromStr for ErrorOrders {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "free-run" => Ok(Self::FreeRun),
            "aic" => Ok(Self::Aic),
            _ => numbers(text, [0, 1]).map(Self::Given).ok_or_else(|| {
                "give free-run, aic, or two numbers, as in 20,20; N_B is at least 1".to_owned()
            }),
        }
    }
}

impl Models {
    /// The recipe, with the sizes that were compared.
    pub(super) fn recipe(
        &self,
        (design, seed): (Design, u64),
        sets: &Sets,
        (recurrent, gmdh): (bool, bool),
    ) -> miette::Result<(Recipe, Option<Selection>)> {
        let orders = |[n_a, n_b]: [usize; 2]| Orders { n_a, n_b, constant: true };
        let error_model = match self.orders {
            ErrorOrders::FreeRun => design.error_model.clone(),
            ErrorOrders::Aic => ErrorModel::ArxUpTo(orders([20, 20])),
            ErrorOrders::Given(given) => ErrorModel::Arx(orders(given)),
        };
        let inputs = sets.excited[0].inputs().len();
        let recipe = Recipe::paper(inputs, Design { error_model, ..design }, seed);
        let mut recipe = recipe.settling_within(sets);
        if self.search == Search::Ars {
            let searched = |training: Training| Training {
                method: Method::AdaptiveRandomSearch { outer: OUTER },
                starts: SEARCHES,
                ..training
            };
            recipe.training = searched(recipe.training);
            recipe.recurrent_error =
                recipe.recurrent_error.map(|(sizes, training)| (sizes, searched(training)));
        }
        let mut compared = None;
        recipe.structure = match self.structure {
            Sizes::Paper => recipe.structure,
            Sizes::Given([v1, v2, order]) => Structure { v1, v2, order, ..recipe.structure },
            Sizes::Aic => {
                let found = compared.insert(recipe.compare_sizes(sets).map_err(into_report)?);
                found.rows[found.used].structure
            }
        };
        if let Some((_, bounds)) = &mut recipe.gmdh {
            *bounds = BoundOptions {
                uncertain: match self.uncertain {
                    Bounded::Output => Uncertain::OutputNeuron,
                    Bounded::Every => Uncertain::EveryNeuron,
                },
                orthants: match self.orthants {
                    Where::Estimate => Orthants::OfEstimate,
                    Where::All => Orthants::All,
                },
                ..*bounds
            };
        }
        if !recurrent {
            recipe.recurrent_error = None;
        }
        if !gmdh {
            recipe.gmdh = None;
        }
        Ok((recipe, compared))
    }

    /// The process model where the comparison of sizes has trained it: training it again would leave out
    /// the healthy run. Another search begins anew.
    pub(super) fn process(&self, compared: Option<&Selection>) -> Option<Trained> {
        compared.filter(|_| self.search == Search::Lm).map(|it| it.network().clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_orders_are_read_or_refused() {
        assert_eq!("4,2,1".parse(), Ok(Sizes::Given([4, 2, 1])));
        assert_eq!(("aic".parse(), "free-run".parse()), (Ok(Sizes::Aic), Ok(ErrorOrders::FreeRun)));
        assert_eq!("0,3".parse(), Ok(ErrorOrders::Given([0, 3])));
        for wrong in ["4,2", "0,1,1", "4,2,1,1", "a,b,c", "900,1,1", ""] {
            assert!(wrong.parse::<Sizes>().is_err(), "{wrong}");
        }
        for wrong in ["3", "3,0", "-1,2"] {
            assert!(wrong.parse::<ErrorOrders>().is_err(), "{wrong}");
        }
    }
}
