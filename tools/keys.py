"""Makes and shows the identities of a network: an authority, the robot's and the operator's.

P-256 keys. The robot's certificate serves only, the operator's connects only: with the operator's nobody can
pass for the robot.
"""

from __future__ import annotations

import ipaddress
import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from surefoot.bus.errors import BusError
from surefoot.bus.identity import AUTHORITY_FILE, ROBOT, Identity, KeysError, addresses, check_identity
from surefoot.config.network import OPERATOR

AUTHORITY = "authority"
"""Folder of the authority's private key: it signs identities and belongs on neither machine."""

_SKEW = timedelta(minutes=5)  # between the clocks of two machines
_AUTHORITY_DAYS = 3650


@dataclass(frozen=True)
class Shown:
    """What there is to know of one identity.

    Attributes:
        name: whose.
        until: its last day; None when it cannot be read.
        addresses: that it may be reached by.
        authority: fingerprint of who signed it; that of both machines must be the same.
        trouble: why it cannot be used; empty when it can.
    """

    name: str
    until: datetime | None
    addresses: list[str]
    authority: str
    trouble: str


def make_keys(folder: Path, robot: Sequence[str], days: int) -> None:
    """Make all identities.

    Args:
        folder: a new folder for them.
        robot: host names and IP addresses by which the operator's machine reaches the robot.
        days: how long the identities are valid.

    Raises:
        KeysError: the folder has something in it.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise KeysError(f"{folder} exists: nothing is overwritten; give another folder, or remove it yourself")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    folder.chmod(0o700)
    root_key, root = _make_authority()
    public = root.public_bytes(Encoding.PEM)
    _write(folder / AUTHORITY, {"authority.key": _private(root_key), AUTHORITY_FILE: public})
    for name, names, usage in (
        (ROBOT, robot, ExtendedKeyUsageOID.SERVER_AUTH),
        (OPERATOR, (), ExtendedKeyUsageOID.CLIENT_AUTH),
    ):
        key, certificate = _make_identity(name, names, usage, root_key, root, days)
        _write(
            folder / name,
            {
                f"{name}.key": _private(key),
                f"{name}.pem": certificate.public_bytes(Encoding.PEM),
                AUTHORITY_FILE: public,
            },
        )


def shown(folder: Path) -> list[Shown]:
    """The identities in a folder.

    Raises:
        KeysError: there are none.
    """
    found = [Identity(name, folder / name) for name in (ROBOT, OPERATOR) if (folder / name).is_dir()]
    if not found:
        raise KeysError(f"{folder} has no identities: make them with `surefoot keys init {folder}`")
    return [_show(identity) for identity in found]


def _show(identity: Identity) -> Shown:
    trouble = ""
    try:
        check_identity(identity)
    except BusError as error:
        trouble = str(error)
    try:
        certificate = x509.load_pem_x509_certificate(identity.certificate.read_bytes())
        authority = x509.load_pem_x509_certificate(identity.authority.read_bytes())
    except (OSError, ValueError):
        return Shown(identity.name, None, [], "", trouble)
    mark = authority.fingerprint(hashes.SHA256()).hex()[:16]
    return Shown(identity.name, certificate.not_valid_after_utc, addresses(certificate), mark, trouble)


def _make_authority() -> tuple[ec.EllipticCurvePrivateKey, x509.Certificate]:
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name("surefoot authority")
    usage = x509.KeyUsage(False, False, False, False, False, True, False, False, False)  # signs certificates only
    builder = _builder(name, name, key.public_key(), _AUTHORITY_DAYS)
    builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    return key, builder.add_extension(usage, critical=True).sign(key, hashes.SHA256())


def _make_identity(
    name: str,
    reached_by: Sequence[str],
    usage: x509.ObjectIdentifier,
    root_key: ec.EllipticCurvePrivateKey,
    root: x509.Certificate,
    days: int,
) -> tuple[ec.EllipticCurvePrivateKey, x509.Certificate]:
    key = ec.generate_private_key(ec.SECP256R1())
    builder = _builder(_name(name), root.subject, key.public_key(), days)
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    builder = builder.add_extension(x509.ExtendedKeyUsage([usage]), critical=True)
    names = [_general_name(each) for each in reached_by or [name]]  # TLS libraries want one, also of a client
    builder = builder.add_extension(x509.SubjectAlternativeName(names), critical=False)
    return key, builder.sign(root_key, hashes.SHA256())


def _builder(subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePublicKey, days: int):
    now = datetime.now(UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _SKEW)
        .not_valid_after(now + timedelta(days=days))
    )


def _name(common: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common)])


def _general_name(address: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(address))
    except ValueError:
        return x509.DNSName(address)


def _private(key: ec.EllipticCurvePrivateKey) -> bytes:
    return key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())


def _write(folder: Path, files: dict[str, bytes]) -> None:
    """New files that only their owner may read, from the first byte on."""
    folder.mkdir(mode=0o700)
    (folder / ".gitignore").write_text("# Private keys: never part of a repository.\n*\n")
    for name, content in files.items():
        descriptor = os.open(folder / name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, stat.S_IRUSR | stat.S_IWUSR)
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
