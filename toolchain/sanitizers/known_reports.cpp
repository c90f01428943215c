// What ThreadSanitizer reports of others' libraries, which PCL and OpenCV load.
extern "C" const char* __tsan_default_suppressions();  // looked up by the sanitizer, before main
const char* __tsan_default_suppressions() {
  return "mutex:libOpenNI2\n"
         "deadlock:libgdal\n";
}
