!> Text that grows, with number writers far faster than formatted I/O.
module lopin_text_buffer
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use lopin_kinds, only : wp, lk
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: text_buffer_type

   integer, parameter :: reach = 120
   integer :: k_
   real(wp), parameter :: power_of_ten(-reach:reach) = [(10.0_wp**k_, k_=-reach, reach)]
   character(len=1), parameter :: newline = achar(10)

   !> The text is `text(:n)`; what stands behind is room to grow.
   type :: text_buffer_type
      integer :: n = 0
      character(len=:), allocatable :: text
   contains
      procedure :: put
      procedure :: put_line
      procedure :: put_integer
      procedure :: put_exponential
      procedure :: content
      procedure :: clear
      procedure :: keep
   end type text_buffer_type

contains

   subroutine put(self, text)
      class(text_buffer_type), intent(inout) :: self
      character(len=*), intent(in) :: text

      call reserve(self, len(text))
      self%text(self%n + 1:self%n + len(text)) = text
      self%n = self%n + len(text)
   end subroutine put

   !> The text, to a stream or back.
   subroutine keep(self, stream)
      class(text_buffer_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      character(len=:), allocatable :: text

      if (.not. stream%reading) text = self%content()
      call stream%pass(text)
      if (.not. stream%reading .or. stream%broken) return
      call self%clear()
      call self%put(text)
   end subroutine keep

   !> Text and the end of the line.
   subroutine put_line(self, text)
      class(text_buffer_type), intent(inout) :: self
      character(len=*), intent(in), optional :: text

      if (present(text)) call self%put(text)
      call self%put(newline)
   end subroutine put_line

   !> An integer at the right of a field (as Iw), or as short as it is if it does not fit.
   subroutine put_integer(self, value, width)
      class(text_buffer_type), intent(inout) :: self
      integer, intent(in) :: value, width
      character(len=24) :: digits
      integer(lk) :: rest
      integer :: i, field

      i = len(digits)
      rest = abs(int(value, lk))
      do
         digits(i:i) = achar(iachar('0') + int(mod(rest, 10_lk)))
         rest = rest/10
         if (rest == 0) exit
         i = i - 1
      end do
      if (value < 0) then
         i = i - 1
         digits(i:i) = '-'
      end if
      field = max(width, len(digits) - i + 1)
      call reserve(self, field)
      self%text(self%n + 1:self%n + field) = ''
      self%text(self%n + field - len(digits) + i:self%n + field) = digits(i:)
      self%n = self%n + field
   end subroutine put_integer

   !> A real as 1P,Ew.d with w = digits + 7; what is below 1e-99 is written as zero.
   subroutine put_exponential(self, value, digits)
      class(text_buffer_type), intent(inout) :: self
      real(wp), intent(in) :: value
      integer, intent(in) :: digits      !! behind the point, 1..15
      character(len=32) :: field
      integer(lk) :: mantissa
      integer :: exponent, width, i

      width = digits + 7
      if (.not. ieee_is_finite(value) .or. abs(value) > 9.0e99_wp) then
         call put_slowly(self, value, digits)
         return
      end if
      call split(abs(value), digits, mantissa, exponent)
      do i = digits + 3, 4, -1
         field(i:i) = achar(iachar('0') + int(mod(mantissa, 10_lk)))
         mantissa = mantissa/10
      end do
      field(1:1) = merge('-', ' ', value < 0.0_wp)
      field(2:2) = achar(iachar('0') + int(mantissa))
      field(3:3) = '.'
      field(digits + 4:digits + 4) = 'E'
      field(digits + 5:digits + 5) = merge('-', '+', exponent < 0)
      exponent = abs(exponent)
      field(digits + 6:digits + 6) = achar(iachar('0') + exponent/10)
      field(width:width) = achar(iachar('0') + mod(exponent, 10))
      call self%put(field(:width))
   end subroutine put_exponential

   function content(self) result(text)
      class(text_buffer_type), intent(in) :: self
      character(len=:), allocatable :: text

      text = ''
      if (self%n > 0) text = self%text(:self%n)
   end function content

   !> Forget the text, keep the room.
   subroutine clear(self)
      class(text_buffer_type), intent(inout) :: self
      self%n = 0
   end subroutine clear

   !> value = mantissa * 10**(exponent - digits) with digits + 1 figures in the mantissa.
   pure subroutine split(value, digits, mantissa, exponent)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      integer(lk), intent(out) :: mantissa
      integer, intent(out) :: exponent

      mantissa = 0
      exponent = 0
      if (value < 1.0e-99_wp) return
      exponent = floor(log10(value))
      mantissa = nint(value*power_of_ten(digits - exponent), lk)
      if (mantissa >= 10_lk**(digits + 1)) then
         exponent = exponent + 1
         mantissa = nint(value*power_of_ten(digits - exponent), lk)
      else if (mantissa < 10_lk**digits) then
         exponent = exponent - 1
         mantissa = nint(value*power_of_ten(digits - exponent), lk)
      end if
   end subroutine split

   subroutine put_slowly(self, value, digits)
      class(text_buffer_type), intent(inout) :: self
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(len=16) :: form
      character(len=32) :: field

      write (form, '("(1p,e",i0,".",i0,")")') digits + 7, digits
      write (field, form) value
      call self%put(field(:digits + 7))
   end subroutine put_slowly

   subroutine reserve(self, more)
      class(text_buffer_type), intent(inout) :: self
      integer, intent(in) :: more
      character(len=:), allocatable :: grown

      if (.not. allocated(self%text)) allocate (character(len=max(4096, more)) :: self%text)
      if (self%n + more <= len(self%text)) return
      allocate (character(len=2*len(self%text) + more) :: grown)
      grown(:self%n) = self%text(:self%n)
      call move_alloc(grown, self%text)
   end subroutine reserve
end module lopin_text_buffer
