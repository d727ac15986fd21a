!> Settings: what cards of the deck say that is kept as it is written, shown and reported.
!>
!> A row of the keyword table declares them (`reported`, `lopin_keyword_table`). A procedure that
!> needs one asks for it by its name; a card that is not in the deck has no setting.
module lopin_settings
   use lopin_kinds, only : wp
   implicit none
   private
   public :: settings_type, setting_type

   type :: setting_type
      character(len=:), allocatable :: name   !! `KEYWORD` of data lines, `KEYWORD, PARAMETER`
      character(len=:), allocatable :: text   !! as written; data lines with a blank between them
      logical :: is_number = .false.
      real(wp) :: value = 0.0_wp              !! if it is a number
   end type setting_type

   type :: settings_type
      type(setting_type), allocatable :: item(:)   !! in the order of the deck; unallocated: none
   contains
      procedure :: add
      procedure :: count_all
      procedure :: text
      procedure :: number
   end type settings_type

contains

   !> Keep a setting. Data lines of one keyword are one text; of a parameter the last value holds.
   subroutine add(self, new)
      class(settings_type), intent(inout) :: self
      type(setting_type), intent(in) :: new
      integer :: i

      if (.not. allocated(self%item)) allocate (self%item(0))
      i = place_of(self, new%name)
      if (i == 0) then
         self%item = [self%item, new]
      else if (index(new%name, ',') == 0) then
         self%item(i)%text = self%item(i)%text//' '//new%text
      else
         self%item(i) = new
      end if
   end subroutine add

   pure integer function count_all(self)
      class(settings_type), intent(in) :: self

      count_all = 0
      if (allocated(self%item)) count_all = size(self%item)
   end function count_all

   !> What the deck says; '' if nothing.
   pure function text(self, name)
      class(settings_type), intent(in) :: self
      character(len=*), intent(in) :: name    !! `KEYWORD` or `KEYWORD, PARAMETER`
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      i = place_of(self, name)
      if (i > 0) text = self%item(i)%text
   end function text

   !> The number that the deck gives a parameter.
   pure real(wp) function number(self, name, default)
      class(settings_type), intent(in) :: self
      character(len=*), intent(in) :: name    !! `KEYWORD, PARAMETER`
      real(wp), intent(in) :: default         !! if the deck gives none
      integer :: i

      number = default
      i = place_of(self, name)
      if (i == 0) return
      if (self%item(i)%is_number) number = self%item(i)%value
   end function number

   pure integer function place_of(self, name) result(place)
      class(settings_type), intent(in) :: self
      character(len=*), intent(in) :: name

      do place = 1, self%count_all()
         if (self%item(place)%name == name) return
      end do
      place = 0
   end function place_of
end module lopin_settings
