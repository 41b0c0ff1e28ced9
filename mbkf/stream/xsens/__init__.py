"""Xsens MVN's network streaming: datagrams, samples joined from them, and source."""
