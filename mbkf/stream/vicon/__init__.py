"""Vicon's DataStream: objects on the wire, client, description, plates and source."""
