"""Every message in its place: order, restarts, second publishers, late readers."""

from surefoot.bus.codec import encode
from surefoot.bus.messages import JointCommand
from surefoot.bus.session import Marked
from surefoot.bus.topics import PROCESSES
from surefoot.components.component import Inbox
from surefoot.components.elevation_map.elevation_map import ElevationMap
from surefoot.components.input_sequence import KEPT
from surefoot.components.stepper import Stepper
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.config.deployment import Deployment, Run

KEY = "joint/command"
WRITER, OTHER = b"the one ", b"another "


def packed(seq, boot=0, t=0.0):
    return encode(JointCommand(t=t, seq=seq, boot=boot, valid=True))


def marked(payload, writer=WRITER):
    """As it comes from a writer's session."""
    payload = Marked(payload)
    payload.writer = writer
    return payload


class Reader:
    def __init__(self, trigger=None):
        self.buffers, self.inbox = TopicBuffers((KEY,), trigger), Inbox((KEY,))

    def put(self, *payloads):
        for payload in payloads:
            self.buffers.put(KEY, payload)

    def read(self, visible, kept=()):
        """Sequence numbers and boots handed over; `kept` is there for who asks."""
        self.inbox.clear_new()
        self.lost = self.buffers.deliver_visible({KEY: visible}, self.inbox, 0.01, lambda key: list(kept))
        return [(message.seq, message.boot) for message in self.inbox.new(KEY)]


def test_exactly_what_is_visible_is_handed_over_in_order():
    reader = Reader()
    reader.put(packed(1), packed(0), packed(2))
    assert reader.read(2) == [(0, 0), (1, 0)]
    assert reader.read(2) == []
    assert reader.read(3) == [(2, 0)] and reader.buffers.bad == 0


def test_a_message_that_does_not_come_is_named_and_skipped():
    reader = Reader()
    reader.put(packed(0), packed(2))
    assert reader.read(3) == [(0, 0), (2, 0)]
    assert "message 1 of 3 did not arrive" in reader.lost


def test_while_nobody_can_be_asked_nothing_is_skipped_and_what_was_kept_takes_its_place():
    reader, kept = Reader(), [packed(seq) for seq in range(2, 100)]
    answers = iter([None, None, kept])
    reader.put(*(packed(seq) for seq in range(40)))
    reader.read(40)
    reader.put(packed(41), packed(43))
    reader.inbox.clear_new()
    lost = reader.buffers.deliver_visible({KEY: 43}, reader.inbox, 0.01, lambda key: next(answers))
    assert [message.seq for message in reader.inbox.new(KEY)] == [40, 41, 42]
    assert not lost and reader.buffers.bad == 0 and next(answers, "asked thrice") == "asked thrice"
    assert reader.read(60)[0] == (43, 0) and len(reader.inbox.new(KEY)) == 17 and reader.buffers.bad == 0


def test_a_second_publisher_is_told_and_dropped():
    reader = Reader()
    reader.put(packed(0), packed(0), packed(0, t=9.0), packed(10**6))
    assert reader.read(1) == [(0, 0)] and reader.buffers.bad == 2
    reader.put(packed(0, t=8.0), packed(1))
    assert reader.read(2) == [(1, 0)] and reader.buffers.bad == 3
    assert reader.buffers.incidents.words(0.0).startswith(f"dropped {KEY}: message 0 is out of place")


def test_what_a_restarted_writer_says_replaces_what_was_not_visible_yet():
    reader = Reader()
    reader.put(packed(0), packed(1), packed(1, boot=1, t=1.0), packed(2, boot=1))
    assert reader.read(3) == [(0, 0), (1, 1), (2, 1)] and reader.buffers.bad == 0


def test_what_was_sent_before_the_reader_was_there_is_asked_for():
    reader = Reader()
    reader.put(packed(0), packed(3))
    assert [seq for seq, _ in reader.read(4, kept=[packed(seq) for seq in range(3)])] == [0, 1, 2, 3]
    assert reader.read(5, kept=[packed(3)]) == [] and "message 4 of 5" in reader.lost
    assert reader.buffers.bad == 0


def test_a_step_that_was_over_and_is_said_again_is_no_second_publisher():
    reader = Reader()
    reader.put(packed(0), packed(1))
    assert len(reader.read(2)) == 2
    reader.put(packed(1, boot=1), packed(2, boot=1))
    assert reader.read(3) == [(2, 1)] and reader.buffers.bad == 0
    reader.put(packed(1, boot=1, t=5.0))
    reader.read(3)
    assert reader.buffers.bad == 1


def test_what_another_session_says_is_dropped_however_plausible():
    reader = Reader()
    reader.put(marked(packed(0)), *(marked(packed(seq, t=9.0), OTHER) for seq in range(4)), marked(packed(1)))
    reader.buffers.trust({"wbc": [WRITER]})
    assert reader.read(2) == [(0, 0), (1, 0)] and reader.inbox.latest(KEY).t == 0.0
    assert reader.buffers.bad == 2 and "a second publisher's" in reader.buffers.incidents.words(0.0)
    reader.put(
        marked(packed(2)), marked(packed(10**6), OTHER), marked(packed(0), OTHER), marked(packed(3, t=9.0), b"")
    )
    assert reader.read(3) == [(2, 0)] and reader.inbox.latest(KEY).t == 0.0
    assert reader.buffers.bad == 5
    reader.put(marked(packed(3)))
    assert reader.read(4) == [(3, 0)] and reader.inbox.latest(KEY).t == 0.0
    assert reader.buffers.bad == 7


def test_a_flood_of_another_session_does_not_push_out_the_writer():
    reader = Reader()
    reader.put(marked(packed(0)), marked(packed(1)))
    reader.put(*(marked(packed(seq), OTHER) for seq in range(5000)))
    reader.put(*(marked(packed(seq, t=9.0), b"%8d" % seq) for seq in range(100)))
    reader.buffers.trust({"wbc": [WRITER]})
    reader.put(marked(packed(2)))
    assert reader.read(3) == [(0, 0), (1, 0), (2, 0)]


def test_a_process_that_has_just_come_up_may_be_heard_before_the_master_tells_of_it():
    reader = Reader()
    reader.buffers.trust({"wbc": [WRITER]})
    reader.put(marked(packed(0)), marked(packed(1, boot=1), OTHER))
    assert reader.read(1) == [(0, 0)] and reader.buffers.bad == 0
    reader.buffers.trust({"wbc": [WRITER, OTHER]})
    reader.put(marked(packed(2, boot=1), OTHER))
    assert reader.read(3) == [(1, 1), (2, 1)] and reader.buffers.bad == 0


def test_in_real_time_another_session_is_dropped_until_the_writer_has_been_silent():
    reader = Reader(trigger=KEY)
    for k in range(30):
        reader.put(marked(packed(k, t=0.01 * k)), marked(packed(100 + k, t=0.01 * k), OTHER))
        reader.buffers.deliver_all(reader.inbox)
    assert [message.seq for message in reader.inbox.new(KEY)] == list(range(30)) and reader.buffers.bad == 30
    reader.put(*(marked(packed(200 + k, t=0.3 + 0.1 * k), OTHER) for k in range(20)))
    reader.buffers.deliver_all(reader.inbox)
    assert reader.inbox.latest(KEY).seq == 219 and reader.inbox.new(KEY)[30].t > 1.0


def test_a_new_reader_takes_the_place_of_the_old_one():
    reader = Reader()
    kept = {KEY: [marked(packed(seq)) for seq in range(2, 8)]}
    kept[KEY] += [marked(packed(seq, t=9.0), OTHER) for seq in range(8)]
    reader.put(marked(packed(7)))
    reader.buffers.trust({"io": [b"nobody", WRITER], "wbc": [WRITER]})
    reader.buffers.resume({KEY: 5}, {KEY: 7}, kept, reader.inbox)
    assert reader.inbox.latest(KEY).t == 0.0 and reader.buffers.bad == 8
    assert reader.inbox.latest(KEY).seq == 4 and not reader.inbox.new(KEY)
    assert [seq for seq, _ in reader.read(7)] == [5, 6]
    assert [seq for seq, _ in reader.read(8)] == [7] and reader.buffers.bad == 8


def test_a_reader_that_is_released_seldom_gets_the_last_ones():
    reader = Reader()
    reader.put(*(packed(seq) for seq in range(1000)))
    assert [seq for seq, _ in reader.read(1000)] == list(range(1000 - KEPT, 1000))
    assert reader.buffers.bad == 0 and not reader.lost


def test_in_real_time_what_falls_behind_is_dropped_until_it_is_a_sequence_of_its_own():
    reader = Reader(trigger=KEY)
    reader.put(packed(5), packed(3), packed(6), packed(0, boot=1), packed(7), packed(1, boot=1))
    reader.buffers.deliver_all(reader.inbox)
    assert [(m.seq, m.boot) for m in reader.inbox.new(KEY)] == [(5, 0), (6, 0), (0, 1), (1, 1)]
    assert reader.buffers.bad == 2
    reader.put(*(packed(seq) for seq in range(20, 40)))
    reader.buffers.deliver_all(reader.inbox)
    assert reader.inbox.latest(KEY).seq == 39


class Session:
    """In place of the bus: says what of each topic is asked for."""

    def __init__(self):
        self.asked = {}

    def subscribe(self, key, receive):
        self.asked[key] = "all"

    def newest(self, key):
        self.asked[key] = "newest"
        return lambda: None


def test_in_real_time_a_reader_gets_the_newest_of_a_stream_or_all_of_it_if_it_says_so():
    keys = ("hw/depth", "state/estimate", "fsm/reference", "fsm/event")
    for complete, estimates in (((), "newest"), (("state/estimate",), "all")):
        session = Session()
        TopicBuffers(keys, "", complete).connect(session)
        assert session.asked == {
            "hw/depth": "newest",
            "state/estimate": estimates,
            "fsm/reference": "newest",
            "fsm/event": "all",
        }


def test_a_whole_stream_is_handed_over_in_order():
    buffers, inbox = TopicBuffers((KEY,), "", (KEY,)), Inbox((KEY,))
    for seq in range(10):
        buffers.put(KEY, packed(seq))
    buffers.deliver_all(inbox)
    assert [message.seq for message in inbox.new(KEY)] == list(range(10)) and buffers.bad == 0


def test_a_process_asks_for_what_its_component_wants_whole():
    session = Session()
    session.serve = session.serve_each = lambda key, answer: None
    seeing = ElevationMap(Deployment(run=Run(vision=True)))
    Stepper(seeing, session, PROCESSES["elevation_map"], simulated=False).connect()
    assert session.asked["state/estimate"] == "all"
