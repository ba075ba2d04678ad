//! A report as a Digital Calibration Certificate: the XML format of Physikalisch-Technische Bundesanstalt, version 3.3.0, with
//! quantities in D-SI.

use nalgebra::DMatrix;
use quick_xml::escape::escape;
use tautline_core::statistics::chi_square_quantile;
use tautline_session::{CalibratedInstrument, day};

use super::content::certificate::{SCOPE, overdue_when_used};
use super::content::conformity;
use super::input::ReportInput;
use super::tolerance::rule_in_words;
use crate::audit;
use crate::history::date;
use crate::identification::{
    COVERAGE_PROBABILITY, FitVerdict, Identification, entry_points_covariance,
};
use crate::wording::{PROGRAM, list};

/// Start of the document.
const ROOT: &str = r#"digitalCalibrationCertificate xmlns:dcc="https://ptb.de/dcc" xmlns:si="https://ptb.de/si" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="https://ptb.de/dcc https://ptb.de/dcc/v3.3.0/dcc.xsd" schemaVersion="3.3.0""#;
/// Axes of the base frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Why there is no Digital Calibration Certificate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DccError {
    /// The format requires what is not stated.
    #[error("a Digital Calibration Certificate needs: {0}")]
    Missing(String),
    /// There are no values with uncertainties.
    #[error(
        "a Digital Calibration Certificate needs identified values whose uncertainties are valid"
    )]
    NoResult,
}

/// The content of the XML file.
///
/// # Errors
/// If the session does not state what the format requires, or has no values with valid uncertainties.
pub fn render(input: &ReportInput<'_>) -> Result<String, DccError> {
    refuse_incomplete(input)?;
    let fit = input.fit.filter(|_| !input.outdated);
    let fit = fit
        .filter(|fit| FitVerdict::of(fit.solution.p_value()).holds() && fit.solution.converged());
    let results = results(fit.ok_or(DccError::NoResult)?).ok_or(DccError::NoResult)?;
    let root = node(ROOT, [administration(input), measurement(input, results)]);
    Ok(format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{root}\n"
    ))
}

/// Names the fields that the format requires and that are empty.
fn refuse_incomplete(input: &ReportInput<'_>) -> Result<(), DccError> {
    let details = &input.session.settings.certificate;
    let is_date = |text: &str| day(text).is_some();
    let needed = [
        (
            "Number of the certificate",
            !details.number.trim().is_empty(),
        ),
        ("Laboratory", !details.laboratory.trim().is_empty()),
        (
            "Country of the laboratory, two capital letters",
            details.has_country(),
        ),
        ("First day of measuring", is_date(&details.measured_from)),
        ("Last day of measuring", is_date(&details.measured_to)),
        ("Temperature", details.temperature_c.is_some()),
        ("Company", !input.choice.company.trim().is_empty()),
        ("Operator", !input.choice.operator.trim().is_empty()),
    ];
    let missing = needed.iter().filter(|(_, is_there)| !is_there);
    let missing: Vec<&str> = missing.map(|(name, _)| *name).collect();
    match missing.as_slice() {
        [] => Ok(()),
        missing => Err(DccError::Missing(list(missing))),
    }
}

/// An element of the DCC with others in it; the name may have attributes.
fn node(name: &str, children: impl IntoIterator<Item = String>) -> String {
    let content: String = children.into_iter().collect();
    let end = name.split(' ').next().unwrap_or(name);
    format!("<dcc:{name}>{content}</dcc:{end}>")
}

/// An element of the DCC with a text.
fn leaf(name: &str, text: &str) -> String {
    node(name, [escape(text.trim()).into_owned()])
}

/// An element of the DCC with a text in English.
fn text(name: &str, english: &str) -> String {
    node(name, [leaf("content lang=\"en\"", english)])
}

/// An element of D-SI with others or a number in it.
fn si(name: &str, content: impl AsRef<str>) -> String {
    format!("<si:{name}>{}</si:{name}>", content.as_ref())
}

/// A list of numbers, each as the shortest text that gives it back.
fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    let shown = values.into_iter().map(|value| format!("{value:e}"));
    shown.collect::<Vec<_>>().join(" ")
}

/// A number without exponent.
fn plain(value: &f64) -> String {
    format!("{value:.4}")
}

/// The coverage probability; the schema allows no exponent there, nor in coverage factors.
fn probability() -> String {
    COVERAGE_PROBABILITY.to_string()
}

/// A person or company whose name and address are one text.
fn contact(name: &str, who: &str) -> String {
    node(
        name,
        [text("name", who), node("location", [text("further", who)])],
    )
}

fn serial_number(value: &str) -> Option<String> {
    (!value.trim().is_empty()).then(|| {
        let identification = [
            leaf("issuer", "manufacturer"),
            leaf("value", value),
            text("name", "Serial number"),
        ];
        let one = node(
            "identification refType=\"basic_serialNumber\"",
            identification,
        );
        node("identifications", [one])
    })
}

/// The program with its version, which begins with a letter there.
fn software() -> String {
    let (program, release) = PROGRAM.rsplit_once(' ').unwrap_or((PROGRAM, "0"));
    let release = leaf("release", &format!("v{release}"));
    node("software", [text("name", program), release])
}

fn administration(input: &ReportInput<'_>) -> String {
    let details = &input.session.settings.certificate;
    let software = software();
    let core = [
        leaf("countryCodeISO3166_1", &details.country),
        leaf("usedLangCodeISO639_1", "en"),
        leaf("mandatoryLangCodeISO639_1", "en"),
        leaf("uniqueIdentifier", &details.number),
        leaf("beginPerformanceDate", &details.measured_from),
        leaf("endPerformanceDate", &details.measured_to),
        leaf("performanceLocation", "other"),
        leaf("issueDate", &date(input.now)),
    ];
    let robot = &input.session.robot;
    let maker = details.manufacturer.trim();
    let maker = (!maker.is_empty()).then(|| node("manufacturer", [text("name", maker)]));
    let number = serial_number(robot.serial_number.as_deref().unwrap_or_default());
    let number = number.unwrap_or_else(|| {
        // The format wants one identification of each item.
        let named = [leaf("issuer", "customer"), leaf("value", &robot.name)];
        node("identifications", [node("identification", named)])
    });
    let item = [Some(text("name", &robot.name)), maker, Some(number)];
    let person = node("person", [text("name", &input.choice.operator)]);
    let person = node("respPerson", [person, leaf("mainSigner", "true")]);
    node(
        "administrativeData",
        [
            node("dccSoftware", [software]),
            node("coreData", core),
            node("items", [node("item", item.into_iter().flatten())]),
            node(
                "calibrationLaboratory",
                [contact("contact", &details.laboratory)],
            ),
            node("respPersons", [person]),
            contact("customer", &input.choice.company),
            node("statements", statements(input)),
        ],
    )
}

/// Scope, conformity with its decision rule, what stands in the way of relying on it, and the audit trail.
fn statements(input: &ReportInput<'_>) -> Vec<String> {
    let mut texts = vec![SCOPE.to_owned()];
    if let Some(verdict) = conformity::verdict(input) {
        let rule = input.session.settings.certificate.decision_rule;
        texts.push(format!("{verdict} {}", rule_in_words(rule)));
    }
    if input.session.is_simulated() {
        texts.push(
            "SIMULATED DATA: these readings are of a simulated robot, not of a machine.".to_owned(),
        );
    }
    texts.extend(overdue_when_used(input.session, input.now));
    texts.push(format!("Audit trail: {}.", audit::state(input.session)));
    let statement = |english: &String| node("statement", [text("declaration", english)]);
    texts.iter().map(statement).collect()
}

fn measurement(input: &ReportInput<'_>, results: String) -> String {
    let details = &input.session.settings.certificate;
    let method = [
        text("name", "Joint least squares of pulleys and poses"),
        leaf("norm", "JCGM 100:2008"),
        leaf("reference", "doi:10.3390/s18072392"),
    ];
    let equipment: Vec<String> = details.instruments.iter().map(equipment).collect();
    let equipment = (!equipment.is_empty()).then(|| node("measuringEquipments", equipment));
    let temperature = details.temperature_c.map(|celsius| {
        let uncertainty = details.temperature_sd_k.map(|kelvin| {
            let expanded = [
                si("valueExpandedMU", numbers([2.0 * kelvin])),
                si("coverageFactor", "2"),
                si("coverageProbability", probability()),
            ];
            let expanded = si("expandedMU", expanded.concat());
            si("measurementUncertaintyUnivariate", expanded)
        });
        let value = [
            si("value", numbers([celsius])),
            si("unit", r"\degreecelsius"),
            uncertainty.unwrap_or_default(),
        ];
        let quantity = node(
            "quantity",
            [text("name", "Temperature"), si("real", value.concat())],
        );
        let condition = [text("name", "Temperature"), node("data", [quantity])];
        node(
            "influenceConditions",
            [node(
                "influenceCondition refType=\"basic_temperature\"",
                condition,
            )],
        )
    });
    let parts = [
        Some(text("name", "Places of the pulleys")),
        Some(node("usedMethods", [node("usedMethod", method)])),
        Some(node("usedSoftware", [software()])),
        equipment,
        temperature,
        Some(node("results", [results])),
    ];
    let result = node("measurementResult", parts.into_iter().flatten());
    node("measurementResults", [result])
}

fn equipment(instrument: &CalibratedInstrument) -> String {
    let stated = [
        ("Certificate", &instrument.certificate),
        ("calibrated on", &instrument.calibrated_on),
        ("due on", &instrument.due_on),
        ("traceable to", &instrument.traceable_to),
    ];
    let stated = stated.iter().filter(|(_, value)| !value.trim().is_empty());
    let stated: Vec<String> = stated
        .map(|(name, value)| format!("{name} {value}"))
        .collect();
    let parts = [
        Some(text("name", &instrument.name)),
        (!stated.is_empty()).then(|| text("description", &list(&stated))),
        serial_number(&instrument.serial_number),
    ];
    node("measuringEquipment", parts.into_iter().flatten())
}

/// All coordinates of the entry points that were estimated, with their expanded uncertainties and their joint covariance; `None`
/// without uncertainties.
fn results(fit: &Identification) -> Option<String> {
    let budget = fit.budget()?;
    let cables = &fit.dataset.robot.cables;
    let covariance = entry_points_covariance(&fit.solution, cables.len())?;
    let is_estimated = |row: &usize| covariance[(*row, *row)] > 0.0;
    let rows: Vec<usize> = (0..covariance.nrows()).filter(is_estimated).collect();
    let factors = rows
        .iter()
        .map(|row| budget.coverage_factor_of(&cables[row / 3].name));
    let factors: Vec<f64> = factors.collect::<Option<_>>()?;
    let known = covariance.select_rows(&rows).select_columns(&rows);
    let expanded = (0..rows.len()).map(|k| factors[k] * known[(k, k)].sqrt());
    // A label has no blanks, which separate them.
    let label = |row: &usize| {
        let name = cables[row / 3].name.replace(char::is_whitespace, "_");
        format!("{}.{}", escape(name.as_str()), AXES[row % 3])
    };
    let labels: Vec<String> = rows.iter().map(label).collect();
    let found = &fit.solution.globals.entry_points;
    let values = rows.iter().map(|row| found[row / 3][row % 3]);
    let univariate = [
        si("valueExpandedMUXMLList", numbers(expanded)),
        si(
            "coverageFactorXMLList",
            factors.iter().map(plain).collect::<Vec<_>>().join(" "),
        ),
        si("coverageProbabilityXMLList", probability()),
        si("distributionXMLList", "student-t"),
    ];
    let univariate = si("expandedMUXMLList", univariate.concat());
    let list = [
        si("labelXMLList", labels.join(" ")),
        si("valueXMLList", numbers(values)),
        si("unitXMLList", r"\metre"),
        si("measurementUncertaintyUnivariateXMLList", univariate),
        si(
            "measurementUncertaintyMultivariateXMLList",
            ellipsoid(&known)?,
        ),
    ];
    let quantity = node(
        "quantity",
        [
            text("name", "Entry points of the cables in the base frame"),
            si("realListXMLList", list.concat()),
        ],
    );
    let result = [
        text("name", "Entry points of the cables at their pulleys"),
        node("data", [quantity]),
    ];
    Some(node("result", result))
}

/// Covariance (m^2) as the ellipsoid that holds all coordinates with the coverage probability.
fn ellipsoid(covariance: &DMatrix<f64>) -> Option<String> {
    let column = |column: usize| {
        let of = [
            si(
                "valueXMLList",
                numbers(covariance.column(column).iter().copied()),
            ),
            si("unitXMLList", r"\metre\tothe{2}"),
        ];
        si("columnXMLList", si("covarianceXMLList", of.concat()))
    };
    let columns: String = (0..covariance.ncols()).map(column).collect();
    let square = chi_square_quantile(COVERAGE_PROBABILITY, covariance.ncols() as f64)?;
    let region = [
        si("covarianceMatrixXMLList", columns),
        si("coverageFactorXMLList", plain(&square.sqrt())),
        si("coverageProbabilityXMLList", probability()),
        si("distributionXMLList", "normal"),
    ];
    Some(si("ellipsoidalRegionMUXMLList", region.concat()))
}
