"""Reads a page as a browser does, and fails where it is not well formed."""

from html.parser import HTMLParser


class Page(HTMLParser):
    """Fails on a tag that is not closed, or closed by another one; keeps text, sources and links."""

    VOID = ("meta", "img", "br")

    def __init__(self, html):
        super().__init__()
        self.open, self.text, self.sources, self.links, self.ids = [], [], [], [], set()
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in self.VOID:
            self.open.append(tag)
        self.sources += [given[key] for key in ("src", "srcset", "data", "poster") if key in given]
        self.links += [given["href"]] if "href" in given else []
        self.ids |= {given["id"]} if "id" in given else set()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open:
            self.text.append(data)
