// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "veth.hpp"

#include "gateways/ethernet/port.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <grp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace gridspace::ethernet {
namespace {

bool write_file(char const* path, std::string const& text) {
    std::ofstream file{path};
    file << text << std::flush;
    return file.good();
}

/// An empty text, or why there is no namespace.
std::string enter_namespaces() {
    if (char const* const uid = std::getenv("GRIDSPACE_TEST_UID"); uid != nullptr && ::geteuid() == 0) {
        auto const id = static_cast<unsigned>(std::strtoul(uid, nullptr, 10));
        if (::setgroups(0, nullptr) != 0 || ::setresgid(id, id, id) != 0 || ::setresuid(id, id, id) != 0) {
            return std::string{"cannot become another user: "} + std::strerror(errno);
        }
        ::prctl(PR_SET_DUMPABLE, 1); // or its own files under /proc stay root's
    }
    unsigned const uid = ::geteuid(), gid = ::getegid();
    int const flags = CLONE_NEWNET | (uid == 0 ? 0 : CLONE_NEWUSER);
    if (::unshare(flags) != 0) {
        return std::string{"cannot make a network namespace: "} + std::strerror(errno);
    }
    bool mapped = true;
    if (uid != 0) {
        mapped = write_file("/proc/self/setgroups", "deny") &&
                 write_file("/proc/self/uid_map", "0 " + std::to_string(uid) + " 1") &&
                 write_file("/proc/self/gid_map", "0 " + std::to_string(gid) + " 1");
    }
    return mapped ? "" : "cannot map the user of the namespace";
}

} // namespace

std::string Veth::why_not;

void ip(std::string const& arguments) {
    ASSERT_EQ(std::system(("PATH=/usr/sbin:/sbin:$PATH ip " + arguments + " 2>&1").c_str()), 0) << "ip " << arguments;
}

void wait_until_frames_pass(std::string const& from, std::string const& to) {
    constexpr std::uint16_t kExperimental = 0x88B5; // no test looks at it
    PortOptions out{.interface = from, .filter = {}, .receive = false}, in{.interface = to, .filter = {}};
    in.filter.ethertypes = {kExperimental};
    auto sender = Port::open(out), receiver = Port::open(in);
    ASSERT_TRUE(sender && receiver);
    std::vector<std::uint8_t> probe(60);
    iec61850::store_be(probe.data() + 12, kExperimental);
    ReceivedFrame received;
    for (int tries = 0; tries < 5000; ++tries) { // a cable that has just come up may swallow what it says it has taken
        sender->send(probe);
        receiver->wait(1'000'000);
        if (receiver->receive(std::span{&received, 1}) == 1) {
            return;
        }
    }
    FAIL() << "no frame passes from " << from << " to " << to;
}

void Veth::SetUpTestSuite() {
    static bool const once = [] {
        why_not = enter_namespaces();
        return true;
    }();
    (void)once;
}

void Veth::SetUp() {
    if (!why_not.empty()) {
        GTEST_SKIP() << why_not;
    }
    write_file("/proc/sys/net/ipv6/conf/default/disable_ipv6", "1"); // no frames that nobody asked for
    ip("link set lo up");
    ip("link add left type veth peer name right");
    ip("link set left up");
    ip("link set right up");
    wait_until_frames_pass("left", "right");
    wait_until_frames_pass("right", "left");
}

void Veth::TearDown() {
    if (why_not.empty()) {
        [[maybe_unused]] int const ignored = std::system(
            "PATH=/usr/sbin:/sbin:$PATH; for i in left right renamed; do ip link del $i 2>/dev/null; done; true");
    }
}

} // namespace gridspace::ethernet
