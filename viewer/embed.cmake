# cmake -DFILES=a;b -DOUT=x.cpp -P embed.cmake: writes web_files() (web_server.hpp) with the bytes of the files.
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_svg "image/svg+xml")
set(arrays "")
set(table "")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  get_filename_component(extension ${file} LAST_EXT)
  string(SUBSTRING ${extension} 1 -1 extension)
  if(NOT DEFINED type_${extension})
    message(FATAL_ERROR "embed.cmake knows no content type for ${name}")
  endif()
  string(MAKE_C_IDENTIFIER ${name} symbol)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "constexpr char ${symbol}[] = {${bytes}};\n")
  string(APPEND table "      {\"/${name}\", \"${type_${extension}}\", {${symbol}, sizeof ${symbol}}},\n")
endforeach()
file(WRITE ${OUT} "// Made by viewer/embed.cmake.
#include \"viewer/web_server.hpp\"
namespace modslam {
namespace {
${arrays}}  // namespace
const std::vector<WebFile>& web_files() {
  static const std::vector<WebFile> files = {
${table}  };
  return files;
}
}  // namespace modslam
")
