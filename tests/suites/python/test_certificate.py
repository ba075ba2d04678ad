"""The Digital Calibration Certificate, judged by the rules of dcclib and read with lxml: they share no code with the program."""

import subprocess
from datetime import date
from pathlib import Path

import numpy as np
import pytest
from dcclib.validation import SchemaDownloadError, SchematronValidator, XsdValidator
from lxml import etree

import tautline

DETAILS = """
format = "tautline-certificate-details"
version = 1
number = "2026-017"
laboratory = "Robot Works & Sons, Leeds"
country = "GB"
place = "Hall 3"
manufacturer = "Cable Machines"
measured_from = "2026-11-26"
measured_to = "2026-11-27"
temperature_c = 21.5
temperature_sd_k = 0.4

[[instruments]]
name = "Laser <DX-1>"
serial_number = "4711"
certificate = "D-K-1"
calibrated_on = "2026-03-12"
due_on = "2099-03-12"
traceable_to = "PTB"
"""
NAMES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certificate") / "mini"
    run = tautline.simulate(tautline.Robot.preset("mini"), poses=25, seed=5)
    run.dataset.write(folder)
    return folder


@pytest.fixture(scope="module")
def certificate(data: Path, program: Path) -> Path:
    (data.parent / "details.toml").write_text(DETAILS)
    out = data.parent / "certificate.xml"
    who = ["--company", "Owner Ltd", "--operator", "A. Smith", "--tolerance", "20"]
    details = ["--details", str(data.parent / "details.toml")]
    subprocess.run([str(program), "report", str(data), *details, *who, "-o", str(out)], check=True)
    return out


def test_the_certificate_follows_the_rules_of_the_format(certificate: Path) -> None:
    found = SchematronValidator.for_dcc().validate_file(str(certificate))
    errors = [one for one in found.successful_reports if one.role == "error"]
    assert found.is_valid and not found.failed_assertions and not errors, found


def test_the_certificate_is_valid_against_the_schema(certificate: Path) -> None:
    try:
        validator = XsdValidator.from_version("3.3.0")
    except SchemaDownloadError as error:
        pytest.skip(f"the schema of the format is published by PTB, not with its programs: {error}")
    found = validator.validate_file(str(certificate))
    assert found.is_valid, found


def test_its_numbers_are_those_of_identify(certificate: Path, data: Path) -> None:
    root = etree.parse(certificate).getroot()

    def texts(path: str) -> list[str]:
        return [node.text or "" for node in root.iterfind(path, NAMES)]

    def numbers(path: str) -> np.ndarray:
        return np.array([[float(one) for one in text.split()] for text in texts(path)])

    core = ".//dcc:coreData/dcc:"
    assert texts(core + "uniqueIdentifier") == ["2026-017"]
    assert texts(core + "endPerformanceDate") == ["2026-11-27"]
    date.fromisoformat(texts(core + "issueDate")[0])
    assert texts(".//dcc:measuringEquipment/dcc:name/dcc:content") == ["Laser <DX-1>"]
    fit = tautline.identify(tautline.read_dataset(data))
    values = ".//dcc:results//si:realListXMLList/si:"
    assert np.allclose(numbers(values + "valueXMLList")[0], np.ravel(fit.entry_points_m), atol=1e-12)
    sds = np.ravel(np.array(fit.entry_points_sd_m, dtype=float))
    expanded = numbers(".//si:valueExpandedMUXMLList")[0]
    factors = numbers(".//si:expandedMUXMLList/si:coverageFactorXMLList")[0]
    # k of the t distribution is above that of the normal distribution, by little for many readings.
    assert np.all(factors > 2.0) and np.all(factors < 2.2)
    assert np.allclose(expanded, factors * sds, rtol=1e-3)
    covariance = numbers(".//si:columnXMLList/si:covarianceXMLList/si:valueXMLList")
    assert np.allclose(covariance, covariance.T) and np.allclose(np.sqrt(np.diag(covariance)), sds)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)
