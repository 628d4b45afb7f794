# Writes OUTPUT, which defines the function FUNCTION of NAMESPACE, declared in HEADER. The function returns a map from
# the names of FILES in ROOT, without extension, to their texts.
set(map "std::map<std::string_view, std::string_view>")
set(text "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\nconst ${map}& ${FUNCTION}() {\n")
string(APPEND text "  static const ${map} texts = {\n")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} body)
  get_filename_component(name ${file} NAME_WE)
  string(APPEND text "      {\"${name}\", R\"text(${body})text\"},\n")
endforeach()
string(APPEND text "  };\n  return texts;\n}\n\n}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUTPUT} "${text}")
