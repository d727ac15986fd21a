!> VTK unstructured grids (`.vtu`) with raw appended data and 8-byte block headers, and the CRC-32
!> of all of it in a comment behind.
!>
!> Use: `start`, then sections (`section`, arrays, `end_section`), `points`, `cells`, `write`.
!> Fields are single precision, coordinates double.
module lopin_vtu_writer
   use, intrinsic :: iso_fortran_env, only : int8, int32, int64, real32
   use lopin_kinds, only : wp
   use lopin_crc32, only : crc32, hexadecimal
   use lopin_text, only : to_text
   use lopin_error, only : error_type
   use lopin_atomic_file, only : write_atomically, written_mark
   use lopin_text_buffer, only : text_buffer_type
   implicit none
   private
   public :: vtu_writer_type, vtu_cells_type, three_components

   integer(int8), parameter :: format_version = 1_int8

   !> Cells in VTK's layout: node indices from 0, ends of each cell in them, types.
   type :: vtu_cells_type
      integer(int32), allocatable :: connectivity(:), offsets(:)
      integer(int8), allocatable :: types(:)
   end type vtu_cells_type

   type :: vtu_writer_type
      private
      type(text_buffer_type) :: xml
      integer(int8), allocatable :: bytes(:)
      integer(int64) :: n = 0
      character(len=:), allocatable :: current      !! section that is open
   contains
      procedure :: start
      procedure :: section
      procedure :: end_section
      procedure :: reals
      procedure :: integers
      procedure :: points
      procedure :: cells
      procedure :: write => write_file
   end type vtu_writer_type

contains

   subroutine start(self, npoint, ncell, time)
      class(vtu_writer_type), intent(inout) :: self
      integer, intent(in) :: npoint, ncell
      real(wp), intent(in) :: time

      call self%xml%clear()
      self%n = 0
      call self%xml%put_line('<?xml version="1.0"?>')
      call self%xml%put_line(written_mark)
      call self%xml%put_line('<VTKFile type="UnstructuredGrid" version="1.0" '// &
         & 'byte_order="LittleEndian" header_type="UInt64">')
      call self%xml%put_line('<UnstructuredGrid>')
      call self%xml%put_line('<FieldData><DataArray type="Float64" Name="TimeValue" '// &
         & 'NumberOfTuples="1" format="ascii">'//to_text(time)//'</DataArray>')
      ! One byte first: no later block starts at a multiple of 4. meshio 5.3 finds blocks by where
      ! they start, while it gives those already read new starts that are multiples of 4.
      call describe(self, 'UInt8', 'Format', 1)
      call add_block(self, [format_version])
      call self%xml%put_line('</FieldData>')
      call self%xml%put_line('<Piece NumberOfPoints="'//to_text(npoint)//'" NumberOfCells="' &
         & //to_text(ncell)//'">')
   end subroutine start

   subroutine section(self, name)
      class(vtu_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name     !! PointData or CellData
      self%current = name
      call self%xml%put_line('<'//name//'>')
   end subroutine section

   subroutine end_section(self)
      class(vtu_writer_type), intent(inout) :: self
      call self%xml%put_line('</'//self%current//'>')
   end subroutine end_section

   !> A field of reals, written in single precision.
   subroutine reals(self, name, values)
      class(vtu_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:, :)      !! (component, item)

      call describe(self, 'Float32', name, size(values, 1))
      call add_block(self, transfer(real(values, real32), [0_int8]))
   end subroutine reals

   subroutine integers(self, name, values)
      class(vtu_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: values(:)

      call describe(self, 'Int32', name, 1)
      call add_block(self, transfer(int(values, int32), [0_int8]))
   end subroutine integers

   subroutine points(self, x)
      class(vtu_writer_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)           !! (2 or 3, npoint) [length]

      call self%xml%put_line('<Points>')
      call describe(self, 'Float64', 'Points', 3)
      call add_block(self, transfer(three_components(x), [0_int8]))
      call self%xml%put_line('</Points>')
   end subroutine points

   subroutine cells(self, list)
      class(vtu_writer_type), intent(inout) :: self
      type(vtu_cells_type), intent(in) :: list

      call self%xml%put_line('<Cells>')
      call describe(self, 'Int32', 'connectivity', 0)
      call add_block(self, transfer(list%connectivity, [0_int8]))
      call describe(self, 'Int32', 'offsets', 0)
      call add_block(self, transfer(list%offsets, [0_int8]))
      call describe(self, 'UInt8', 'types', 0)
      call add_block(self, list%types)
      call self%xml%put_line('</Cells>')
   end subroutine cells

   subroutine write_file(self, path, error)
      class(vtu_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: newline = achar(10)
      character(len=*), parameter :: last = newline//'</AppendedData>'//newline
      integer(int32) :: sum_

      call self%xml%put_line('</Piece>')
      call self%xml%put_line('</UnstructuredGrid>')
      call self%xml%put('<AppendedData encoding="raw">'//newline//'_')
      sum_ = crc32(0_int32, transfer(self%xml%text(:self%xml%n), [0_int8]))
      sum_ = crc32(crc32(sum_, self%bytes(:self%n)), transfer(last, [0_int8]))
      call write_atomically(path, self%xml%text(:self%xml%n), error, bytes=self%bytes(:self%n), &
         & tail=last//'<!-- CRC-32 '//hexadecimal(sum_)//' -->'//newline//'</VTKFile>'//newline)
   end subroutine write_file

   !> Vectors of the plane get a third component, 0, so that filters of vectors work.
   pure function three_components(values) result(padded)
      real(wp), intent(in) :: values(:, :)
      real(wp) :: padded(3, size(values, 2))
      integer :: n

      n = min(3, size(values, 1))
      padded(:n, :) = values(:n, :)
      padded(n + 1:, :) = 0.0_wp
   end function three_components

   subroutine describe(self, type_name, name, ncomponent)
      class(vtu_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: type_name, name
      integer, intent(in) :: ncomponent        !! 0: say nothing
      character(len=20) :: offset

      write (offset, '(i0)') self%n
      call self%xml%put('<DataArray type="'//type_name//'" Name="'//name//'"')
      if (ncomponent > 0) call self%xml%put(' NumberOfComponents="'//to_text(ncomponent)//'"')
      call self%xml%put_line(' format="appended" offset="'//trim(offset)//'"/>')
   end subroutine describe

   subroutine add_block(self, block_)
      class(vtu_writer_type), intent(inout) :: self
      integer(int8), intent(in) :: block_(:)
      integer(int8), allocatable :: grown(:)
      integer(int64) :: length

      length = size(block_, kind=int64)
      if (.not. allocated(self%bytes)) allocate (self%bytes(max(65536_int64, length + 8)))
      if (self%n + length + 8 > size(self%bytes, kind=int64)) then
         allocate (grown(2*size(self%bytes, kind=int64) + length + 8))
         grown(:self%n) = self%bytes(:self%n)
         call move_alloc(grown, self%bytes)
      end if
      self%bytes(self%n + 1:self%n + 8) = transfer(length, self%bytes(:8))
      self%bytes(self%n + 9:self%n + 8 + length) = block_
      self%n = self%n + 8 + length
   end subroutine add_block
end module lopin_vtu_writer
