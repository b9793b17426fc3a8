# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Prints a line per ARP frame that this host sees, until it is told to end."""
import socket

ETH_P_ARP = 0x0806
with socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ARP)) as heard:
    print("listening", flush=True)
    while True:
        frame, (interface, *_) = heard.recvfrom(2048)
        print("arp", interface, frame.hex(), flush=True)
