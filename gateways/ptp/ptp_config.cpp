// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ptp/ptp_config.hpp"

namespace gridspace::ptp {

void describe_ptp(config::Fields& f, std::optional<PtpConfig>& ptp) {
    f.object(
        "ptp",
        {.doc = "real time: smpSynch is what a PTP daemon (linuxptp) says of the clock, instead of the stream's "
                "`synch`"},
        [&](config::Fields& p) {
            PtpConfig& c = ptp.emplace();
            p.text(
                "socket", c.socket,
                {.doc =
                     "the daemon's `uds_address`; of a relative one `program: exec` of the same run has the folder"});
            p.integer("domain", c.domain, {.doc = "domainNumber", .min = 0, .max = 255});
            p.number("within_us", c.within_us,
                     {.doc = "further from its grandmaster it is not synchronised", .max = 1e6, .above = 0});
            p.number("holdover_s", c.holdover_s,
                     {.doc = "how long smpSynch stays as it was when the grandmaster is lost", .min = 0, .max = 86400});
        });
}

} // namespace gridspace::ptp
