//! The JSON Schema of the plan file, from which editors complete it.

use drivescope_plant::file::without_null;
use schemars::generate::SchemaSettings;

use super::layout::Layout;

/// The JSON Schema of plan files, as text that ends in a line break.
pub fn schema_json() -> String {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<Layout>().to_value();
    without_null(&mut schema);
    format!("{schema:#}\n")
}
