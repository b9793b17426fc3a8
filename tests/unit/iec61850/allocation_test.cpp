// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The hot paths of the wire ask nobody for memory.
#include "hex.hpp"

#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/stream_alignment.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "tests/support/allocations.hpp"

#include <gtest/gtest.h>
#include <memory>

namespace gridspace::iec61850 {
namespace {

TEST(Allocations, AreCounted) { // or the tests below could not fail
    EXPECT_GT(allocations_of([] { auto const p = std::make_unique<std::string>(100, 'x'); }), 0U);
}

TEST(Allocations, NoneForSampledValues) {
    SvPublisher publisher{*SvTemplate::create(sv_address(), {asdu("MU", 12)}), 4800};
    auto const frame = std::make_unique<SvFrame>();
    SvSubscription s;
    s.sv_id = "MU";
    SvSubscriber subscriber{s};
    auto const alignment = std::make_unique<StreamAlignment<float>>(1'000'000, 4800);
    EXPECT_EQ(allocations_of([&] {
                  for (std::int64_t i = 0; i < 10'000; ++i) {
                      store_float(publisher.sample(i), 0, 1.0F);
                      Octets const octets = publisher.commit();
                      if (decode_sv(octets, *frame) &&
                          subscriber.receive(frame->header, frame->asdus[0], i * 208'333).accepted) {
                          alignment->push(0, frame->asdus[0].smp_cnt, 2, 1.0F, i);
                          alignment->push(1, frame->asdus[0].smp_cnt, 2, 1.0F, i);
                          (void)alignment->pop(i);
                      }
                      (void)decode_sv(octets.first(static_cast<std::size_t>(i % 60)), *frame);
                  }
              }),
              0U);
    EXPECT_EQ(subscriber.counters().samples, 10'000U);
}

TEST(Allocations, NoneForGooseEvenWhenItsLengthsChange) {
    GooseDescription description = one_boolean();
    description.data_set = {
        {DataNode::leaf("n", BasicType::int32), DataNode::leaf("text", BasicType::visible_string, 40)}};
    GoosePublisher publisher{
        *GooseTemplate::create(sv_address(), description), 1, {.timing = {1'000'000, 10'000'000, 2, 3, 30}}};
    GooseSubscription s;
    s.gocb_ref = description.gocb_ref;
    s.data_set = description.data_set;
    GooseSubscriber subscriber{s};
    GooseFrame message;
    std::string const text(40, 'x');
    publisher.start(0, 0);
    EXPECT_EQ(allocations_of([&] {
                  for (std::int64_t i = 0; i < 10'000; ++i) {
                      publisher.set(0, Value::integer(BasicType::int32, i % 7 == 0 ? i * i : i));
                      publisher.set(1,
                                    Value::visible(std::string_view{text}.substr(0, static_cast<std::size_t>(i % 40))));
                      publisher.commit(i * 1'000'000, i);
                      if (decode_goose(publisher.take(i * 1'000'000), message)) {
                          subscriber.receive(message, i * 1'000'000);
                      }
                      subscriber.expire(i * 1'000'000);
                      (void)subscriber.value(1);
                  }
              }),
              0U);
    EXPECT_GT(subscriber.counters().of(GooseEvent::state_change), 9'000U);
}

} // namespace
} // namespace gridspace::iec61850
