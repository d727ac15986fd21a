!> JSON text, indented; what is not finite becomes null.
module lopin_json_writer
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use lopin_kinds, only : wp
   use lopin_safe_text, only : json_text
   use lopin_text, only : to_text
   use lopin_text_buffer, only : text_buffer_type
   implicit none
   private
   public :: json_writer_type

   !> Use: `open` and `close` objects and lists in pairs, `add` between. Names are empty inside
   !> lists.
   type :: json_writer_type
      type(text_buffer_type) :: text
      integer, private :: depth = 0
      logical, private :: fresh = .true.    !! nothing yet in the open object or list
   contains
      procedure :: open => open_group
      procedure :: close => close_group
      procedure :: null => add_null
      procedure, private :: add_text, add_integer, add_real, add_reals
      generic :: add => add_text, add_integer, add_real, add_reals
      procedure, private :: start
   end type json_writer_type

contains

   subroutine open_group(self, bracket, name)
      class(json_writer_type), intent(inout) :: self
      character(len=1), intent(in) :: bracket     !! { or [
      character(len=*), intent(in) :: name

      call self%start(name)
      call self%text%put(bracket)
      self%depth = self%depth + 1
      self%fresh = .true.
   end subroutine open_group

   subroutine close_group(self, bracket)
      class(json_writer_type), intent(inout) :: self
      character(len=1), intent(in) :: bracket     !! } or ]

      self%depth = self%depth - 1
      if (.not. self%fresh) then
         call self%text%put_line()
         call self%text%put(repeat('  ', self%depth))
      end if
      call self%text%put(bracket)
      if (self%depth == 0) call self%text%put_line()
      self%fresh = .false.
   end subroutine close_group

   subroutine add_null(self, name)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      call self%start(name)
      call self%text%put('null')
   end subroutine add_null

   !> An unallocated text counts as absent: null.
   subroutine add_text(self, name, value)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=*), intent(in), optional :: value

      call self%start(name)
      if (present(value)) then
         call self%text%put('"'//json_text(value)//'"')
      else
         call self%text%put('null')
      end if
   end subroutine add_text

   subroutine add_integer(self, name, value)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: value
      call self%start(name)
      call self%text%put_integer(value, 1)
   end subroutine add_integer

   subroutine add_real(self, name, value)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      call self%start(name)
      call self%text%put(number(value))
   end subroutine add_real

   subroutine add_reals(self, name, values)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      integer :: i

      call self%start(name)
      call self%text%put('[')
      do i = 1, size(values)
         if (i > 1) call self%text%put(', ')
         call self%text%put(number(values(i)))
      end do
      call self%text%put(']')
   end subroutine add_reals

   !> Comma, new line, indentation and name.
   subroutine start(self, name)
      class(json_writer_type), intent(inout) :: self
      character(len=*), intent(in) :: name

      if (.not. self%fresh) call self%text%put(',')
      if (self%depth > 0) then
         call self%text%put_line()
         call self%text%put(repeat('  ', self%depth))
      end if
      self%fresh = .false.
      if (len(name) > 0) call self%text%put('"'//json_text(name)//'": ')
   end subroutine start

   function number(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text
      text = 'null'
      if (ieee_is_finite(value)) text = to_text(value)
   end function number
end module lopin_json_writer
