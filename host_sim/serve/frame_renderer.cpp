#include "host_sim/serve/frame_renderer.hpp"

namespace lf::serve {

void fill_size(RecordInfo& info, const optics::Frame& frame) {
  info.kind = 0;
  info.width = frame.width;
  info.height = frame.height;
  info.stride = frame.width;
}

bool ThreadRenderer::submit(const PictureOrder& order) {
  if (waiting_.size() >= most_pictures_under_way) return false;
  waiting_.push_back({order.info, worker_.submit(order.shot)});
  return true;
}

bool ThreadRenderer::take(Picture& picture) {
  if (waiting_.empty() || !worker_.ready(waiting_.front().ticket)) return false;
  worker_.wait(waiting_.front().ticket, frame_);
  picture.info = waiting_.front().info;
  fill_size(picture.info, frame_);
  picture.pixels.assign(frame_.pixels.begin(), frame_.pixels.end());
  waiting_.pop_front();
  return true;
}

}  // namespace lf::serve
