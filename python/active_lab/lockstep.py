"""The bus of a run in virtual time: `lab run FILE --virtual-time --with script.py` starts the script with a
socket. Time stands still while the script computes, and goes on when it waits (runner/script_client/)."""
import os
import socket
import struct
from typing import Optional, Set, Tuple

#: Environment variable with the number of the socket.
LOCKSTEP = "ACTIVE_LAB_LOCKSTEP"

_HEAD = struct.Struct("<cqII")  # what, utime, bytes of the channel, bytes of the message
_MESSAGE, _TIME, _END = b"m", b"t", b"e"  # from the lab
_HELLO, _SUBSCRIBE, _PUBLISH, _WAIT, _CLOSE = b"h", b"s", b"p", b"w", b"c"  # to the lab


class LockstepBus:
    """As _core.LiveBus."""

    waiting = 0

    def __init__(self, descriptor: int) -> None:
        self._socket = socket.socket(fileno=os.dup(descriptor))
        self._socket.setblocking(True)
        self._channels: Set[str] = set()
        #: Whether the run is over. Messages may still be published.
        self.over = False
        self._gone = False
        self._write(_HELLO, 0, b"", b"")
        what, self.now, _, _ = self._read()
        self.over = what == _END

    def subscribe(self, channel: str) -> None:
        if channel not in self._channels:
            self._channels.add(channel)
            self._write(_SUBSCRIBE, 0, channel.encode(), b"")

    def publish(self, channel: str, message: bytes) -> None:
        self._write(_PUBLISH, 0, channel.encode(), message)

    def receive(self, until_utime: int) -> Optional[Tuple[str, int, bytes]]:
        """The next message; None: there was none until `until_utime`, or the run is `over`."""
        if self.over:
            return None
        self._write(_WAIT, until_utime, b"", b"")
        what, utime, channel, message = self._read()
        self.now = max(self.now, utime)
        if what == _MESSAGE:
            return channel.decode(), utime, message
        self.over = self.over or what == _END
        return None

    def close(self) -> None:
        self._write(_CLOSE, 0, b"", b"")
        self._socket.close()

    def _write(self, what: bytes, utime: int, channel: bytes, message: bytes) -> None:
        if self._gone:
            return
        try:
            self._socket.sendall(_HEAD.pack(what, utime, len(channel), len(message)) + channel + message)
        except OSError:
            self._gone = self.over = True

    def _read(self) -> Tuple[bytes, int, bytes, bytes]:
        head = self._exactly(_HEAD.size)
        if head is None:
            return _END, 0, b"", b""
        what, utime, channel_size, message_size = _HEAD.unpack(head)
        body = self._exactly(channel_size + message_size)
        if body is None:
            return _END, utime, b"", b""
        return what, utime, body[:channel_size], body[channel_size:]

    def _exactly(self, size: int) -> Optional[bytes]:
        parts = []
        while size > 0:
            try:
                part = self._socket.recv(size)
            except OSError:
                part = b""
            if not part:
                self._gone = self.over = True
                return None
            parts.append(part)
            size -= len(part)
        return b"".join(parts)
