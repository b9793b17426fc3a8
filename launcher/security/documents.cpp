// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/security/documents.hpp"

#include <ctime>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr std::string_view kHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
    "xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/{}\">\n";

std::string escaped(std::string_view text) {
    std::string out;
    for (char const c : text) {
        switch (c) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        default:
            out += c;
        }
    }
    return out;
}

std::string_view kind(Protection protection) {
    return protection == Protection::none ? "NONE" : protection == Protection::sign ? "SIGN" : "ENCRYPT";
}

std::string domain_set(std::vector<int> const& domains) {
    std::string out = "      <domains>\n";
    for (int const domain : domains) {
        out += fmt::format("        <id>{}</id>\n", domain);
    }
    return out + "      </domains>\n";
}

std::string topic_rule(std::string_view topic, SecuritySettings::Topic const& protection) {
    return fmt::format("        <topic_rule>\n"
                       "          <topic_expression>{}</topic_expression>\n"
                       "          <enable_discovery_protection>true</enable_discovery_protection>\n"
                       "          <enable_liveliness_protection>true</enable_liveliness_protection>\n"
                       "          <enable_read_access_control>true</enable_read_access_control>\n"
                       "          <enable_write_access_control>true</enable_write_access_control>\n"
                       "          <metadata_protection_kind>{}</metadata_protection_kind>\n"
                       "          <data_protection_kind>{}</data_protection_kind>\n"
                       "        </topic_rule>\n",
                       escaped(topic), kind(protection.submessages), kind(protection.data));
}

std::string utc(std::int64_t unix_s) {
    auto const time = static_cast<std::time_t>(unix_s);
    std::tm parts{};
    gmtime_r(&time, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
    return text;
}

std::string topic_list(std::string_view word, std::set<std::string> const& topics) {
    if (topics.empty()) {
        return "";
    }
    std::string out = fmt::format("        <{}>\n          <topics>\n", word);
    for (std::string const& topic : topics) {
        out += fmt::format("            <topic>{}</topic>\n", escaped(topic));
    }
    return out + fmt::format("          </topics>\n        </{}>\n", word);
}

std::string property(std::string_view name, std::string_view value) {
    return fmt::format("            <property><name>{}</name><value>{}</value></property>\n", name, escaped(value));
}
std::string file_property(std::string_view name, std::filesystem::path const& file) {
    return property(name, "file://" + file.string());
}

} // namespace

std::string governance(SecuritySettings const& security, std::vector<int> const& domains) {
    std::string out = fmt::format(kHead, "omg_shared_ca_governance.xsd");
    out += "  <domain_access_rules>\n    <domain_rule>\n" + domain_set(domains);
    out += fmt::format("      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
                       "      <enable_join_access_control>true</enable_join_access_control>\n"
                       "      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
                       "      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
                       "      <rtps_protection_kind>{}</rtps_protection_kind>\n"
                       "      <topic_access_rules>\n",
                       kind(security.messages));
    for (auto const& [topic, protection] : security.topics) { // the first rule that fits counts
        out += topic_rule(topic, protection);
    }
    out += topic_rule("*", security.all);
    return out + "      </topic_access_rules>\n    </domain_rule>\n  </domain_access_rules>\n</dds>\n";
}

std::string permissions(std::string const& subject, Rights const& rights, std::vector<int> const& domains,
                        crypto::Validity valid) {
    std::string out = fmt::format(kHead, "omg_shared_ca_permissions.xsd");
    out += fmt::format("  <permissions>\n    <grant name=\"process\">\n      <subject_name>{}</subject_name>\n"
                       "      <validity>\n        <not_before>{}</not_before>\n        <not_after>{}</not_after>\n"
                       "      </validity>\n      <allow_rule>\n",
                       escaped(subject), utc(valid.from_unix_s), utc(valid.until_unix_s));
    out += domain_set(domains) + topic_list("publish", rights.publish) + topic_list("subscribe", rights.subscribe);
    return out + "      </allow_rule>\n      <default>DENY</default>\n    </grant>\n  </permissions>\n</dds>\n";
}

Result<std::string> secured_profiles(std::string const& profiles, SecurityFiles const& files) {
    std::string const auth = "dds.sec.auth.builtin.PKI-DH.", access = "dds.sec.access.builtin.Access-Permissions.";
    std::string const block = "\n        <propertiesPolicy>\n          <properties>\n" +
                              property("dds.sec.auth.plugin", "builtin.PKI-DH") +
                              file_property(auth + "identity_ca", files.identity_ca) +
                              file_property(auth + "identity_certificate", files.certificate) +
                              file_property(auth + "private_key", files.key) +
                              (files.revoked.empty() ? "" : file_property(auth + "identity_crl", files.revoked)) +
                              property("dds.sec.access.plugin", "builtin.Access-Permissions") +
                              file_property(access + "permissions_ca", files.permissions_ca) +
                              file_property(access + "governance", files.governance) +
                              file_property(access + "permissions", files.permissions) +
                              property("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC") +
                              "          </properties>\n        </propertiesPolicy>";
    std::string out = profiles;
    std::size_t done = 0;
    for (std::size_t at = out.find("<participant "); at != std::string::npos; at = out.find("<participant ", at)) {
        std::size_t const begin = out.find("<rtps>", at), end = out.find("</participant>", at);
        if (begin == std::string::npos || begin > end) {
            return fail(ExitCode::usage, "a participant profile has no <rtps>", "see qos/README.md");
        }
        out.insert(begin + std::string_view{"<rtps>"}.size(), block);
        at = begin + block.size();
        ++done;
    }
    if (done == 0) {
        return fail(ExitCode::usage, "the QoS profiles have no participant", "see qos/README.md");
    }
    return out;
}

} // namespace gridspace::launcher
