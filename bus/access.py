"""Who may say and hear what on the bus: Zenoh's access control, written from the topic table and the hosts.

Whoever may open the Unix socket may do all. Over the network one identity counts, the operator's: it hears
everything, and says what the processes of its machine say and what a person may ask. Everything else is denied,
so it cannot speak for io, for another process of the robot's machine, or for the clock.
"""

from __future__ import annotations

from surefoot.bus import service_keys
from surefoot.bus.topics import TOPICS
from surefoot.config.network import OPERATOR, Network

_ALL = [
    "put",
    "delete",
    "declare_subscriber",
    "query",
    "reply",
    "declare_queryable",
    "liveliness_token",
    "liveliness_query",
    "declare_liveliness_subscriber",
]


def spoken_over_network(network: Network) -> list[str]:
    """The keys on which the operator's identity may publish."""
    away = network.components_away
    topics = [topic.key for topic in TOPICS.values() if topic.writer in away]
    relief = service_keys.RELIEF_ASK, service_keys.RELIEF_ANSWER
    prefixes = service_keys.DONE, service_keys.HELLO, service_keys.LOG, *relief
    services = [f"{prefix}/{name}" for name in away for prefix in prefixes]
    asked = service_keys.REQUEST, service_keys.TUNE, service_keys.BEAT, service_keys.SUPERVISOR_REQUEST
    return [*topics, *services, *asked]


def answered_over_network(network: Network) -> list[str]:
    """The keys on which the operator's identity may answer."""
    return [f"{service_keys.LOG}/{name}/*" for name in network.components_away]


def access_control(network: Network, namespace: str) -> dict:
    """Zenoh's `access_control` for the hub of a namespace."""
    whole = [f"{namespace}/**"]
    spoken = [f"{namespace}/{key}" for key in spoken_over_network(network)]
    answered = [f"{namespace}/{key}" for key in answered_over_network(network)]
    rules = {
        "all": (["ingress", "egress"], ["**"], _ALL),
        "hear": (["ingress"], whole, ["declare_subscriber"]),
        "be_told": (["egress"], whole, ["put", "delete"]),
        "say": (["ingress"], spoken, ["put"]),
        "be_heard": (["egress"], whole, ["declare_subscriber"]),
        "ask": (["ingress"], whole, ["query"]),
        "be_answered": (["egress"], whole, ["reply", "declare_queryable"]),
    }
    if answered:
        rules["answer"] = (["ingress"], answered, ["reply", "declare_queryable"])
        rules["be_asked"] = (["egress"], answered, ["query"])
    if network.encrypted:
        operator: dict = {"link_protocols": ["tls"], "cert_common_names": [OPERATOR]}
    else:
        operator = {"link_protocols": ["tcp"]}
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [
            {"id": name, "permission": "allow", "flows": flows, "key_exprs": keys, "messages": messages}
            for name, (flows, keys, messages) in rules.items()
        ],
        "subjects": [
            # The socket lies in a folder that only its user may enter: that is the credential.
            {"id": "local", "link_protocols": ["unixsock-stream"]},
            {"id": OPERATOR, **operator},
        ],
        "policies": [
            {"rules": ["all"], "subjects": ["local"]},
            {"rules": [name for name in rules if name != "all"], "subjects": [OPERATOR]},
        ],
    }
