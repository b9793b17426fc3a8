// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/crypto/certificates.hpp"
#include "launcher/scenario/security_settings.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What a process may do on the bus.
struct Rights {
    std::set<std::string> publish, subscribe; ///< topics
};

/// The rules of the bus that hold for everybody in these domains (DDS Security 1.1, 9.4.1.2), as XML that is to be
/// signed: nobody without a certificate, discovery encrypted, and only rights that somebody was given.
[[nodiscard]] std::string governance(SecuritySettings const& security, std::vector<int> const& domains);

/// What the owner of a certificate may publish and subscribe to (DDS Security 1.1, 9.4.1.3), as XML that is to be
/// signed. What is not named is denied.
[[nodiscard]] std::string permissions(std::string const& subject, Rights const& rights, std::vector<int> const& domains,
                                      crypto::Validity valid);

/// The files that a participant of a secured bus needs; absolute names.
struct SecurityFiles {
    std::filesystem::path identity_ca, permissions_ca, revoked, certificate, key, governance, permissions;
};

/// The QoS profiles of a role (qos/ROLE.xml) with the properties by which each of its participants takes part in a
/// secured bus. Fails when the text has no participant profile.
[[nodiscard]] Result<std::string> secured_profiles(std::string const& profiles, SecurityFiles const& files);

} // namespace gridspace::launcher
