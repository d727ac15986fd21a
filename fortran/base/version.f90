!> The version, written once; CMake's project version is the same and a test says so.
module lopin_version
   implicit none
   private
   public :: version

   character(len=*), parameter :: version = '0.1.0'
end module lopin_version
