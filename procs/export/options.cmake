# GeoTIFF and DXF are written by GDAL; no other process pays for it.
find_package(GDAL 3 REQUIRED)
target_link_libraries(module_export PUBLIC GDAL::GDAL)
