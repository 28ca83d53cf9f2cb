# Turns the plant files into one C file of byte arrays. cmake -DOUT=file.c "-DFILES=a.json;b.json" -P embed.cmake
set(arrays "")
set(table "")
set(k 0)
foreach(file ${FILES})
  get_filename_component(name "${file}" NAME_WE)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "static const unsigned char text_${k}[] = {${bytes}};\n")
  string(APPEND table "    {\"${name}\", text_${k}, sizeof(text_${k})},\n")
  math(EXPR k "${k} + 1")
endforeach()
file(WRITE "${OUT}" "#include \"plants/plant_library.h\"\n\n${arrays}\n"
  "const struct plant_text plant_texts[] = {\n${table}    {0, 0, 0},\n};\n")
