"""What a request passes before its route: connections, hosts, keys, body limits, admission."""
