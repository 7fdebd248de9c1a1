//! System Structure and Parameterization 1.0: `SystemStructure.ssd`, and the `.ssp` package that holds
//! it with its FMUs. One flat system of FMU components with their connections, parameter values
//! (within the file or in an `.ssv` beside it) and the default experiment. What goes beyond is refused
//! with its place, not passed over.

use std::fs;
use std::path::{Path, PathBuf};

use roxmltree::Node;

use crate::import::{Conversion, Interface, Limits, Unit, Value, unpack};
use crate::position::{DocumentProblem, Position};
use crate::xml::read::{self as xml, child, children, required, value};

use super::connector::{ConnectorEntry, named};
use super::document::{ComponentEntry, ConnectionEntry, Document, ParameterEntry, wrong};
use super::error::Error;

type Parsed<T> = Result<T, DocumentProblem>;

/// Reads a package; its files live as long as the document.
pub(super) fn read_package(path: &Path) -> Result<Document, Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = unpack(path, &name, Limits::default())
        .map_err(|source| Error::Fmu { component: name, source: Box::new(source) })?;
    let mut document = read(&folder.path().join("SystemStructure.ssd"))?;
    document.package = Some(folder);
    Ok(document)
}

/// Reads a description; other files are looked for beside it.
pub(super) fn read(path: &Path) -> Result<Document, Error> {
    let text = load(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    let parsed = xml::parse(&text).and_then(|tree| document(tree.root_element(), path, &mut files));
    let mut document = parsed.map_err(|problem| at(path, problem))?;
    for (component, prefix, file, place) in files {
        let file = folder.join(file);
        let text = load(&file).map_err(|error| wrong(path, place, error.to_string()))?;
        let parameters =
            xml::parse(&text).and_then(|tree| parameter_set(tree.root_element(), &prefix));
        let parameters = parameters.map_err(|problem| at(&file, problem))?;
        apply(&mut document, component, parameters).map_err(|problem| at(&file, problem))?;
    }
    Ok(document)
}

fn load(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })
}

fn at(path: &Path, DocumentProblem { position, text }: DocumentProblem) -> Error {
    wrong(path, position, text)
}

/// Parameter values in another file: the component (none: the whole system), prefix, file, place.
type Elsewhere = (Option<usize>, String, String, Position);

fn document(root: Node, path: &Path, files: &mut Vec<Elsewhere>) -> Parsed<Document> {
    if root.tag_name().name() != "SystemStructureDescription" {
        let name = root.tag_name().name();
        return Err(xml::problem(
            root,
            format!("the top element is <{name}>, not <SystemStructureDescription>"),
        ));
    }
    let system = child(root, "System").ok_or_else(|| xml::problem(root, "there is no <System>"))?;
    let mut document = Document::empty(path);
    let folder = path.parent().unwrap_or(Path::new(""));
    let units = units(root)?;
    for element in child(system, "Elements")
        .into_iter()
        .flat_map(|list| list.children())
        .filter(Node::is_element)
    {
        match element.tag_name().name() {
            "Component" => document.components.push(component(element, folder, &units)?),
            other => return Err(unsupported(element, &format!("<{other}> within a system"))),
        }
        let at = document.components.len() - 1;
        bind(&mut document, element, Some(at), files)?;
    }
    bind(&mut document, system, None, files)?;
    let declared = child(system, "Connectors").into_iter();
    let declared = declared.flat_map(|list| children(list, "Connector"));
    let declared: Vec<ConnectorEntry> =
        declared.map(|node| ConnectorEntry::read(node, &units)).collect::<Parsed<_>>()?;
    for node in
        child(system, "Connections").into_iter().flat_map(|list| children(list, "Connection"))
    {
        connection(&mut document, node, &declared)?;
    }
    if let Some(experiment) = child(root, "DefaultExperiment") {
        document.start = value(experiment, "startTime")?;
        document.stop = value(experiment, "stopTime")?;
    }
    Ok(document)
}

/// The units that an element defines.
fn units(owner: Node) -> Parsed<Vec<Unit>> {
    let list = child(owner, "Units").into_iter().flat_map(|list| children(list, "Unit"));
    list.map(Unit::read).collect()
}

fn component(node: Node, folder: &Path, units: &[Unit]) -> Parsed<ComponentEntry> {
    let name = required(node, "name")?.to_owned();
    if name.contains('.') {
        return Err(xml::problem(node, format!("the component's name `{name}` has a dot")));
    }
    let kind = node.attribute("type").unwrap_or("application/x-fmu-sharedlibrary");
    if kind != "application/x-fmu-sharedlibrary" {
        return Err(unsupported(node, &format!("a component of type `{kind}`")));
    }
    let kind = match node.attribute("implementation") {
        Some("CoSimulation") => Some(Interface::CoSimulation),
        Some("ModelExchange") => Some(Interface::ModelExchange),
        None | Some("any") => None,
        Some(other) => return Err(unsupported(node, &format!("the implementation `{other}`"))),
    };
    let source = required(node, "source")?;
    let fmu = local(source).ok_or_else(|| unsupported(node, &format!("the source `{source}`")))?;
    let connectors = child(node, "Connectors").into_iter();
    let connectors = connectors.flat_map(|list| children(list, "Connector"));
    Ok(ComponentEntry {
        name,
        fmu: folder.join(fmu),
        kind,
        parameters: Vec::new(),
        connectors: connectors
            .map(|node| ConnectorEntry::read(node, units))
            .collect::<Parsed<_>>()?,
        place: xml::position(node),
    })
}

/// A relative URI as a path: nothing but files beside the description may be reached.
fn local(uri: &str) -> Option<PathBuf> {
    let path = Path::new(uri.strip_prefix("./").unwrap_or(uri));
    let inside = path.components().all(|part| matches!(part, std::path::Component::Normal(_)));
    (inside && !uri.contains("://")).then(|| path.to_owned())
}

fn bind(
    document: &mut Document,
    owner: Node,
    component: Option<usize>,
    files: &mut Vec<Elsewhere>,
) -> Parsed<()> {
    let bindings = child(owner, "ParameterBindings").into_iter();
    for binding in bindings.flat_map(|list| children(list, "ParameterBinding")) {
        if let Some(mapping) = child(binding, "ParameterMapping") {
            return Err(unsupported(mapping, "a parameter mapping"));
        }
        let prefix = binding.attribute("prefix").unwrap_or("").to_owned();
        match (child(binding, "ParameterValues"), binding.attribute("source")) {
            (Some(values), _) => {
                for set in children(values, "ParameterSet") {
                    let parameters = parameter_set(set, &prefix)?;
                    apply(document, component, parameters)?;
                }
            }
            (None, Some(source)) => {
                let wrong = || unsupported(binding, &format!("the source `{source}`"));
                let file = local(source).ok_or_else(wrong)?;
                files.push((
                    component,
                    prefix,
                    file.to_string_lossy().into_owned(),
                    xml::position(binding),
                ));
            }
            (None, None) => return Err(xml::problem(binding, "the binding has no values")),
        }
    }
    Ok(())
}

fn parameter_set(set: Node, prefix: &str) -> Parsed<Vec<ParameterEntry>> {
    let units = units(set)?;
    let list = child(set, "Parameters").into_iter().flat_map(|list| children(list, "Parameter"));
    list.map(|node| {
        let body = node.children().find(Node::is_element);
        let body = body.ok_or_else(|| xml::problem(node, "the parameter has no value"))?;
        let text = || Ok(Value::Text(required(body, "value")?.to_owned()));
        let value = match body.tag_name().name() {
            "Real" | "Integer" => {
                let number = value(body, "value")?;
                Value::Number(
                    number.ok_or_else(|| xml::problem(body, "the parameter has no value"))?,
                )
            }
            "Boolean" | "String" | "Enumeration" => text()?,
            other => return Err(unsupported(body, &format!("a parameter of type <{other}>"))),
        };
        let name = format!("{prefix}{}", required(node, "name")?);
        let unit = body.attribute("unit").map(|name| named(name, &units));
        Ok(ParameterEntry { name, value, unit, place: xml::position(node) })
    })
    .collect()
}

/// Gives parameters to a component, or, named `component.parameter`, to those of the system.
fn apply(
    document: &mut Document,
    component: Option<usize>,
    parameters: Vec<ParameterEntry>,
) -> Parsed<()> {
    for ParameterEntry { name, value, unit, place } in parameters {
        let (target, name) = match component {
            Some(component) => (component, name),
            None => {
                let split = |entry: &ComponentEntry| {
                    Some(name.strip_prefix(&entry.name)?.strip_prefix('.')?.to_owned())
                };
                let found = document
                    .components
                    .iter()
                    .enumerate()
                    .find_map(|(at, entry)| Some((at, split(entry)?)));
                found.ok_or_else(|| DocumentProblem {
                    position: place,
                    text: format!("parameter `{name}` belongs to no component"),
                })?
            }
        };
        let parameter = ParameterEntry { name, value, unit, place };
        document.components[target].parameters.push(parameter);
    }
    Ok(())
}

/// `of_system` are the connectors of the system itself.
fn connection(document: &mut Document, node: Node, of_system: &[ConnectorEntry]) -> Parsed<()> {
    let path = |element: &str, connector: &str| -> Parsed<Option<String>> {
        let connector = required(node, connector)?;
        Ok(node.attribute(element).map(|element| format!("{element}.{connector}")))
    };
    let from = path("startElement", "startConnector")?;
    let to = path("endElement", "endConnector")?;
    let mut scaling = Conversion::IDENTITY;
    if let Some(linear) = child(node, "LinearTransformation") {
        scaling.factor = value(linear, "factor")?.unwrap_or(1.0);
        scaling.offset = value(linear, "offset")?.unwrap_or(0.0);
    } else if let Some(other) = node
        .children()
        .find(|child| child.is_element() && child.tag_name().name().ends_with("Transformation"))
    {
        return Err(unsupported(other, &format!("<{}>", other.tag_name().name())));
    }
    let converts = !value(node, "suppressUnitConversion")?.unwrap_or(false);
    match (from, to) {
        (Some(from), Some(to)) => {
            let place = xml::position(node);
            document.connections.push(ConnectionEntry { from, to, scaling, converts, place });
        }
        // An output of the system itself is there to be seen.
        (Some(from), None) => {
            let name = required(node, "endConnector")?;
            let connector = of_system.iter().find(|connector| connector.name == name);
            let connector = connector.ok_or_else(|| {
                xml::problem(node, format!("the system has no connector `{name}`; declare it"))
            })?;
            document.outputs.push((from.clone(), connector.clone()));
            document.records.push((from, xml::position(node)));
        }
        (None, _) => {
            return Err(unsupported(node, "an input of the system itself, which nothing drives,"));
        }
    }
    Ok(())
}

fn unsupported(node: Node, what: &str) -> DocumentProblem {
    xml::problem(node, format!("{what} is not supported; describe one flat system of FMUs"))
}
