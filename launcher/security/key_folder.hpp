// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/crypto/certificates.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::launcher {

namespace key_files {
inline constexpr char kIdentityCa[] = "identity_ca.pem", kIdentityCaKey[] = "identity_ca.key";
inline constexpr char kPermissionsCa[] = "permissions_ca.pem", kPermissionsCaKey[] = "permissions_ca.key";
inline constexpr char kRevoked[] = "revoked.crl", kIdentities[] = "identities";
} // namespace key_files

/// How long authorities and lists of revoked certificates are valid: one that runs out would refuse everybody.
inline constexpr std::int64_t kTwentyYears = 20LL * 365 * 24 * 3600; // seconds

/// A folder of keys for secured runs (docs/reference/security.md): an authority that says who somebody is, one that
/// says what he may do, a list of certificates that are not to be believed any more, and identities. Private keys have
/// the mode 0600, the folder 0700.
class KeyFolder {
  public:
    /// Makes one, with an identity of each name that is valid as said; the authorities last longer. Fails when the
    /// folder exists and is not empty.
    [[nodiscard]] static Result<KeyFolder> init(std::filesystem::path folder, std::vector<std::string> const& names,
                                                crypto::Validity valid);
    /// Reads one that exists, and looks whether others may read its secrets.
    [[nodiscard]] static Result<KeyFolder> open(std::filesystem::path folder);

    /// When the authority of identities ends: none can be valid for longer.
    [[nodiscard]] Result<std::int64_t> ends_unix_s() const;
    /// A new identity, in the place of an older one of that name.
    [[nodiscard]] Result<void> issue(std::string const& name, crypto::Validity valid) const;
    /// From now on the certificate that `name` has at present is refused.
    [[nodiscard]] Result<void> revoke(std::string const& name, crypto::Validity list_valid) const;

    /// The first of these names that has an identity here, valid at `now_unix_s`. The error says what is wrong with it:
    /// not there, not yet or no longer valid, revoked, of another authority, or readable by others.
    struct Found {
        std::string name;
        std::filesystem::path certificate, key;
        crypto::CertificateFacts facts;
    };
    [[nodiscard]] Result<Found> find(std::vector<std::string> const& names, std::int64_t now_unix_s) const;

    struct Listed {
        std::string name;
        crypto::CertificateFacts facts;
        bool revoked{false};
    };
    [[nodiscard]] Result<std::vector<Listed>> list() const;

    [[nodiscard]] std::filesystem::path const& folder() const { return folder_; }
    [[nodiscard]] std::filesystem::path file(char const* name) const { return folder_ / name; }
    [[nodiscard]] crypto::Identity const& permissions_authority() const { return permissions_ca_; }

  private:
    explicit KeyFolder(std::filesystem::path folder) : folder_{std::move(folder)} {}
    [[nodiscard]] Result<std::vector<std::string>> revoked() const;

    std::filesystem::path folder_; ///< absolute
    crypto::Identity identity_ca_, permissions_ca_;
};

} // namespace gridspace::launcher
