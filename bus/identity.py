"""Who a machine is on the network: a certificate, its private key, and the authority that both sides trust."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.bus.errors import BusError
from surefoot.config.network import OPERATOR, Network

if TYPE_CHECKING:
    from cryptography import x509

ROBOT = "robot"
"""Name of the hub's identity; the other machines share the operator's."""

AUTHORITY_FILE = "authority.pem"

_MAKE = "make identities with `surefoot keys init DIR` and copy each to its machine"


class KeysError(BusError):
    """An identity that cannot be used; says which file and what to do."""


@dataclass(frozen=True)
class Identity:
    """The three files of one identity, in a folder of its name.

    Attributes:
        name: the certificate's common name.
        folder: where the files are.
    """

    name: str
    folder: Path

    @property
    def authority(self) -> Path:
        """Certificate of the authority that signed both sides' certificates."""
        return self.folder / AUTHORITY_FILE

    @property
    def certificate(self) -> Path:
        """What the other side sees."""
        return self.folder / f"{self.name}.pem"

    @property
    def key(self) -> Path:
        """The private key, which never leaves this machine."""
        return self.folder / f"{self.name}.key"


def identity_of(network: Network) -> Identity:
    """The identity of this machine."""
    name = ROBOT if network.at_hub else OPERATOR
    return Identity(name, Path(network.keys_dir) / name)


def check_identity(identity: Identity, address: str = "") -> x509.Certificate:
    """See that an identity will be accepted, before anything starts; its certificate.

    Args:
        identity: which.
        address: a host name or IP address that the certificate must name; "" any.

    Raises:
        KeysError: a file is missing, cannot be read or can be read by others; the certificate is out of date,
            of another name, key, authority or address.
    """
    _, InvalidSignature, load_key = _cryptography()
    for path in (identity.authority, identity.certificate, identity.key):
        if not path.exists():
            raise KeysError(f"{path} is missing: {_MAKE}")
    _check_private(identity.key)
    authority, certificate = _certificate(identity.authority), _certificate(identity.certificate)
    try:
        key = load_key(identity.key.read_bytes(), None)
    except (ValueError, TypeError):
        # The library's words are left out: they might quote the file.
        raise KeysError(f"{identity.key} is not a private key without password: {_MAKE}") from None
    if key.public_key() != certificate.public_key():
        raise KeysError(f"{identity.key} does not belong to {identity.certificate}: {_MAKE}")
    try:
        certificate.verify_directly_issued_by(authority)
    except (ValueError, TypeError, InvalidSignature):
        raise KeysError(f"{identity.certificate} is not signed by {identity.authority}: {_MAKE}") from None
    if common_name(certificate) != identity.name:
        raise KeysError(f"{identity.certificate} is for {common_name(certificate)!r}, not for {identity.name!r}")
    _check_date(identity.authority, authority)
    _check_date(identity.certificate, certificate)
    names = addresses(certificate)
    if address and address not in names:
        raise KeysError(
            f"{identity.certificate} is for {', '.join(names)}, not for network.address = {address!r}: other "
            f"machines would refuse it; `surefoot keys init DIR --robot {address}`"
        )
    return certificate


def common_name(certificate: x509.Certificate) -> str:
    """The name a certificate is for."""
    from cryptography.x509.oid import NameOID

    names = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    return str(names[0].value) if names else ""


def addresses(certificate: x509.Certificate) -> list[str]:
    """Host names and IP addresses that a certificate names."""
    from cryptography import x509

    try:
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return []
    ips = names.get_values_for_type(x509.IPAddress)
    return [*names.get_values_for_type(x509.DNSName), *map(str, ips)]


def _cryptography():
    try:
        from cryptography import x509
        from cryptography.exceptions import InvalidSignature
        from cryptography.hazmat.primitives.serialization import load_pem_private_key
    except ImportError:
        raise KeysError(
            "TLS needs the package cryptography to check keys: pip install 'surefoot[network]'"
        ) from None
    return x509, InvalidSignature, load_pem_private_key


def _certificate(path: Path) -> x509.Certificate:
    x509, _, _ = _cryptography()
    try:
        return x509.load_pem_x509_certificate(path.read_bytes())
    except PermissionError:
        raise KeysError(f"{path} cannot be read by this user: chown it") from None
    except ValueError:
        raise KeysError(f"{path} is not a certificate: {_MAKE}") from None


def _check_private(path: Path) -> None:
    """A private key is its owner's alone."""
    status = path.stat()
    mode = stat.S_IMODE(status.st_mode)
    if mode & 0o077:
        raise KeysError(f"{path} has mode {mode:04o}: others may read this private key; chmod 600 {path}")
    if not os.access(path, os.R_OK):
        raise KeysError(f"{path} cannot be read by this user: chown it, with mode 600")


def _check_date(path: Path, certificate: x509.Certificate) -> None:
    now, begin, end = datetime.now(UTC), certificate.not_valid_before_utc, certificate.not_valid_after_utc
    if now > end:
        raise KeysError(f"{path} expired on {end:%Y-%m-%d}: {_MAKE}")
    if now < begin:
        raise KeysError(
            f"{path} is valid from {begin:%Y-%m-%d %H:%M} UTC on, now is {now:%Y-%m-%d %H:%M}: set the clock"
        )
