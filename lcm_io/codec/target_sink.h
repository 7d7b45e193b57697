// A target that can also listen to a run by itself, with an encoder of its own.
// One rule: where several targets listen to one run, they share an encoder, and this one is not
// made.
#pragma once

#include <optional>

#include "lcm_io/codec/encoder.h"

namespace throng {

class TargetSink : public Sink, public MessageTarget {
 public:
  /// How its messages are to be.
  virtual EncoderOptions encoding() const = 0;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override {
    if (!encoder_) encoder_.emplace(encoding(), static_cast<MessageTarget&>(*this));
    encoder_->begin(run);
  }
  void frame(const RunInfo& run, const Frame& frame) override { encoder_->frame(run, frame); }
  void end(const RunInfo& run, const RunEnd& end) override { encoder_->end(run, end); }

  /// What was said, after begin().
  const Outlet& outlet() const { return encoder_->outlet(); }

 private:
  std::optional<RunEncoder> encoder_;
};

}  // namespace throng
