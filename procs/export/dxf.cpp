// SPDX-License-Identifier: BSD-3-Clause
#include <cpl_error.h>
#include <ogrsf_frmts.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "procs/export/export.hpp"

namespace modslam {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

class Drawing {
 public:
  explicit Drawing(const std::string& path) : path_(path) {
    GDALAllRegister();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("DXF");
    if (!driver) throw std::runtime_error(path_ + ": this GDAL writes no DXF");
    file_.reset(driver->Create(path_.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (file_) layer_ = file_->CreateLayer("entities");
    if (!layer_) throw fail();
  }

  void line(const char* name, const Eigen::Vector2d& a, const Eigen::Vector2d& b) { add(name, string_of({a, b}), ""); }
  void outline(const char* name, Ring ring) {
    if (ring.size() < 3) return;
    ring.push_back(ring.front());
    add(name, string_of(ring), "");
  }
  void text(const char* name, const Eigen::Vector2d& p, const std::string& words) {
    std::string plain;
    for (const char c : words) plain += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 ? '_' : c;
    add(name, OGRPoint(p.x(), p.y()), "LABEL(f:\"Arial\",s:0.3g,p:5,t:\"" + plain + "\")");
  }

 private:
  static OGRLineString string_of(const Ring& points) {
    OGRLineString string;
    for (const Eigen::Vector2d& p : points) string.addPoint(p.x(), p.y());
    return string;
  }
  void add(const char* name, const OGRGeometry& geometry, const std::string& style) {
    OGRFeature feature(layer_->GetLayerDefn());
    feature.SetField("Layer", name);
    if (!style.empty()) feature.SetStyleString(style.c_str());
    feature.SetGeometry(&geometry);
    if (layer_->CreateFeature(&feature) != OGRERR_NONE) throw fail();
  }
  std::runtime_error fail() const { return std::runtime_error(path_ + ": cannot be written: " + CPLGetLastErrorMsg()); }

  struct Closer {
    void operator()(GDALDataset* file) const { GDALClose(file); }
  };
  CPLErrorHandlerPusher quiet_{CPLQuietErrorHandler};
  std::string path_;
  std::unique_ptr<GDALDataset, Closer> file_;
  OGRLayer* layer_ = nullptr;
};

Eigen::Vector2d mean_of(const Ring& ring) {
  Eigen::Vector2d sum(0, 0);
  for (const Eigen::Vector2d& p : ring) sum += p;
  return sum / static_cast<double>(std::max<std::size_t>(1, ring.size()));
}

}  // namespace

void write_dxf(const std::string& path, const SemanticLayers& layers) {
  Drawing drawing(path);
  for (const Wall& wall : layers.walls) drawing.line("WALLS", wall.a, wall.b);
  for (const Door& door : layers.doors) drawing.line("DOORS", door.a, door.b);
  for (const Room& room : layers.rooms) {
    drawing.outline("ROOMS", room.outline);
    if (!room.name.empty()) drawing.text("NAMES", mean_of(room.outline), room.name);
  }
  for (const Object& object : layers.objects) drawing.outline("OBJECTS", object.outline);
}

}  // namespace modslam
