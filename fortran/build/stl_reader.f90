!> STL files, binary and in words: triangles, nothing else.
module lopin_stl_reader
   use, intrinsic :: iso_fortran_env, only : int32, real32
   use lopin_kinds, only : wp, lk
   use lopin_text, only : to_text, upper, parse_real
   use lopin_whole_text, only : read_whole
   implicit none
   private
   public :: read_stl

   integer, parameter :: head = 84     !! bytes before the first facet of a binary file
   integer, parameter :: record = 50   !! bytes of a facet: normal, three corners, two spare

contains

   !> `reason` is empty when all is well; `contrary` counts normals of the file that look against
   !> the order of their corners, which is what counts.
   subroutine read_stl(path, corner, contrary, reason)
      character(len=*), intent(in) :: path
      real(wp), allocatable, intent(out) :: corner(:, :, :)     !! (3, 3, n) [length]
      integer, intent(out) :: contrary
      character(len=:), allocatable, intent(out) :: reason
      character(len=:), allocatable :: bytes
      integer :: length

      contrary = 0
      reason = ''
      allocate (corner(3, 3, 0))
      call read_whole(path, bytes, reason)
      length = len(bytes)
      if (len(reason) > 0) then
         return
      else if (is_binary(bytes)) then
         call read_binary(bytes, corner, contrary)
      else if (is_words(bytes)) then
         call read_words(bytes, corner, contrary, reason)
      else if (length < head) then
         reason = 'its '//to_text(length)//' bytes do not begin with solid, and a binary STL '// &
            & 'file has 84 and more'
      else
         reason = 'it does not begin with solid, and its '//to_text(length)//' bytes are not '// &
            & 'the 84 + 50 n of a binary file; it says n = '//to_text(count_of(bytes))
      end if
      if (reason /= '') return
      if (size(corner, 3) == 0) reason = 'it has no facet'
      if (.not. all(abs(corner) <= huge(1.0_real32))) reason = 'a corner is not a number'
   end subroutine read_stl

   !> A binary file says how many facets it has, and has exactly as many bytes as they need; some
   !> programs write "solid" into the first 80 bytes all the same.
   pure logical function is_binary(bytes)
      character(len=*), intent(in) :: bytes

      is_binary = len(bytes) >= head
      if (is_binary) is_binary = int(len(bytes), lk) == int(head, lk) &
         & + int(record, lk)*int(count_of(bytes), lk)
   end function is_binary

   !> The number of facets in bytes 81 to 84, the least first.
   pure integer function count_of(bytes)
      character(len=*), intent(in) :: bytes
      count_of = int(word_at(bytes, 81))
   end function count_of

   pure integer(int32) function word_at(bytes, i)
      character(len=*), intent(in) :: bytes
      integer, intent(in) :: i

      word_at = ior(ior(iachar(bytes(i:i)), ishft(iachar(bytes(i + 1:i + 1)), 8)), &
         & ior(ishft(iachar(bytes(i + 2:i + 2)), 16), ishft(iachar(bytes(i + 3:i + 3)), 24)))
   end function word_at

   pure logical function is_words(bytes)
      character(len=*), intent(in) :: bytes

      is_words = .false.
      if (len(bytes) < 6) return
      is_words = upper(bytes(:5)) == 'SOLID' .and. scan(bytes(6:6), ' '//achar(9)//achar(10)// &
         & achar(13)) > 0 .and. index(bytes(:min(len(bytes), 4096)), achar(0)) == 0
   end function is_words

   subroutine read_binary(bytes, corner, contrary)
      character(len=*), intent(in) :: bytes
      real(wp), allocatable, intent(out) :: corner(:, :, :)
      integer, intent(inout) :: contrary
      real(wp) :: value(12)
      integer :: i, k, n

      n = count_of(bytes)
      allocate (corner(3, 3, n))
      do i = 1, n
         do k = 1, 12
            value(k) = real(transfer(word_at(bytes, head + 1 + record*(i - 1) + 4*(k - 1)), &
               & 0.0_real32), wp)
         end do
         corner(:, :, i) = reshape(value(4:), [3, 3])
         if (looks_back(value(:3), corner(:, :, i))) contrary = contrary + 1
      end do
   end subroutine read_binary

   pure logical function looks_back(normal, corner)
      real(wp), intent(in) :: normal(3), corner(3, 3)
      real(wp) :: a(3), b(3)

      a = corner(:, 2) - corner(:, 1)
      b = corner(:, 3) - corner(:, 1)
      looks_back = normal(1)*(a(2)*b(3) - a(3)*b(2)) + normal(2)*(a(3)*b(1) - a(1)*b(3)) &
         & + normal(3)*(a(1)*b(2) - a(2)*b(1)) < 0.0_wp
   end function looks_back

   !> `facet normal n n n, outer loop, vertex x y z (three), endloop, endfacet`, any white space.
   subroutine read_words(bytes, corner, contrary, reason)
      character(len=*), intent(in) :: bytes
      real(wp), allocatable, intent(out) :: corner(:, :, :)
      integer, intent(inout) :: contrary
      character(len=:), allocatable, intent(inout) :: reason
      real(wp), allocatable :: grown(:, :, :)
      real(wp) :: normal(3)
      character(len=:), allocatable :: word
      integer :: i, n, k
      logical :: ended

      allocate (corner(3, 3, 256))
      n = 0
      k = 3
      i = 1
      ended = .false.
      normal = 0.0_wp
      do
         call next_word(bytes, i, word)
         if (len(word) == 0) exit
         select case (upper(word))
         case ('NORMAL')
            call three_numbers(bytes, i, normal, reason)
            if (k /= 3) reason = 'facet '//to_text(n)//' has '//to_text(k)//' corners, not 3'
            n = n + 1
            k = 0
            if (n > size(corner, 3)) then
               allocate (grown(3, 3, 2*n))
               grown(:, :, :n - 1) = corner(:, :, :n - 1)
               call move_alloc(grown, corner)
            end if
         case ('VERTEX')
            k = k + 1
            if (n == 0 .or. k > 3) then
               reason = 'facet '//to_text(n)//' has more than 3 corners'
            else
               call three_numbers(bytes, i, corner(:, k, n), reason)
               if (k == 3) contrary = contrary + merge(1, 0, looks_back(normal, corner(:, :, n)))
            end if
         case ('SOLID', 'ENDSOLID')
            ! The rest of the line is a name, which may be any word.
            ended = upper(word) == 'ENDSOLID'
            i = i + scan(bytes(i:)//achar(10), achar(10)//achar(13))
         end select
         if (reason /= '') exit
      end do
      if (reason == '' .and. (k /= 3 .or. .not. ended)) reason = 'it ends after '//to_text(n)// &
         & ' facets, without endsolid'
      corner = corner(:, :, :n)
   end subroutine read_words

   subroutine three_numbers(bytes, i, value, reason)
      character(len=*), intent(in) :: bytes
      integer, intent(inout) :: i
      real(wp), intent(out) :: value(3)
      character(len=:), allocatable, intent(inout) :: reason
      character(len=:), allocatable :: word
      logical :: ok
      integer :: k

      value = 0.0_wp
      do k = 1, 3
         call next_word(bytes, i, word)
         call parse_real(word, value(k), ok)
         if (.not. ok) reason = '"'//word//'" is not a number'
         if (.not. ok) return
      end do
   end subroutine three_numbers

   pure subroutine next_word(bytes, i, word)
      character(len=*), intent(in) :: bytes
      integer, intent(inout) :: i                               !! where to go on
      character(len=:), allocatable, intent(out) :: word        !! '' at the end
      integer :: first

      do while (i <= len(bytes))
         if (iachar(bytes(i:i)) > 32) exit
         i = i + 1
      end do
      first = i
      do while (i <= len(bytes))
         if (iachar(bytes(i:i)) <= 32) exit
         i = i + 1
      end do
      word = bytes(first:i - 1)
   end subroutine next_word
end module lopin_stl_reader
