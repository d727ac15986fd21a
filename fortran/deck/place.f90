!> Where in a deck a block stands: model, part, assembly, step; and which keyword it belongs to.
module lopin_place
   use lopin_block, only : deck_type, complain
   use lopin_error, only : log_type
   use lopin_keyword_table, only : keyword_type, status_of
   use lopin_text, only : to_text
   use lopin_word_list, only : in_list, list_item, list_size
   implicit none
   private
   public :: place_type, enter, leave_deck

   integer, parameter :: deepest = 8

   type :: place_type
      integer :: parent = 0                      !! last block that has others under it, which what
                                                 !! is read past does not
      integer :: depth = 0
      integer :: opened(deepest) = 0             !! blocks that are open: *STEP, *PART ...
      character(len=1) :: level(0:deepest) = 'M' !! M, P, A, S
   contains
      procedure :: shown
   end type place_type

contains

   !> The parent block as a message shows it: `*SURFACE INTERACTION, NAME=GREASE (line 138)`.
   function shown(self, deck) result(text)
      class(place_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: text
      integer :: i

      associate (block => deck%block(self%parent))
         text = '*'//block%keyword
         do i = 1, size(block%parameter)
            text = text//', '//block%parameter(i)%name
            if (block%parameter(i)%has_value) text = text//'='//block%parameter(i)%value
         end do
         text = text//' (line '//to_text(block%at%line)//')'
      end associate
   end function shown

   !> Take note of a known block; complain when it does not belong where it stands.
   subroutine enter(self, deck, known, number, log)
      type(place_type), intent(inout) :: self
      type(deck_type), intent(in) :: deck
      type(keyword_type), intent(in) :: known
      integer, intent(in) :: number        !! of the block
      type(log_type), intent(inout) :: log

      if (index(known%name, 'END ') == 1) then
         call close_place(self, deck, number, log)
         self%parent = 0
         return
      end if
      call check_place(self, deck, known, number, log)
      select case (known%name)
      case ('STEP')
         call open_place(self, number, 'S')
      case ('PART')
         call open_place(self, number, 'P')
      case ('ASSEMBLY', 'INSTANCE')
         call open_place(self, number, 'A')
      end select
      if (len(known%parents) == 0 .and. known%status == status_of%supported) self%parent = number
   end subroutine enter

   subroutine check_place(self, deck, known, number, log)
      type(place_type), intent(inout) :: self
      type(deck_type), intent(in) :: deck
      type(keyword_type), intent(in) :: known
      integer, intent(in) :: number
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: note

      associate (block => deck%block(number))
         if (index(known%levels, self%level(self%depth)) == 0) then
            note = ''
            if (self%depth > 0) note = opener(self, deck)//' is still open'
            call complain(log, 'E0107', '*'//known%name//' cannot stand '// &
               & level_name(self%level(self%depth)), &
               & block%at, label='belongs '//level_name(known%levels(1:1)), note=note)
            if (known%name == 'STEP') self%depth = 0
            return
         end if
         if (len(known%parents) == 0) return
         if (self%parent > 0) then
            if (in_list(known%parents, deck%block(self%parent)%keyword)) return
            note = 'here it follows '//self%shown(deck)
         else
            note = ''
         end if
         call complain(log, 'E0107', '*'//known%name//' must follow *'//parents(known), block%at, &
            & note=note, &
            & help="lopin doc '*"//known%name//"'")
      end associate
   end subroutine check_place

   function parents(known) result(text)
      type(keyword_type), intent(in) :: known
      character(len=:), allocatable :: text
      integer :: i

      text = list_item(known%parents, 1)
      do i = 2, list_size(known%parents)
         text = text//' or *'//list_item(known%parents, i)
      end do
   end function parents

   pure function level_name(level) result(name)
      character(len=1), intent(in) :: level
      character(len=:), allocatable :: name

      select case (level)
      case ('M')
         name = 'outside parts and steps'
      case ('P')
         name = 'in a part'
      case ('A')
         name = 'in an assembly'
      case default
         name = 'in a step'
      end select
   end function level_name

   subroutine open_place(self, number, level)
      type(place_type), intent(inout) :: self
      integer, intent(in) :: number
      character(len=1), intent(in) :: level

      if (self%depth == deepest) return
      self%depth = self%depth + 1
      self%opened(self%depth) = number
      self%level(self%depth) = level
   end subroutine open_place

   !> *END STEP and its kin close what is open last.
   subroutine close_place(self, deck, number, log)
      type(place_type), intent(inout) :: self
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: number
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: wanted

      wanted = deck%block(number)%keyword(5:)
      if (self%depth > 0) then
         if (deck%block(self%opened(self%depth))%keyword == wanted) then
            self%depth = self%depth - 1
            return
         end if
         call complain(log, 'E0113', '*END '//wanted//' does not close '//opener(self, deck), &
            & deck%block(number)%at)
      else
         call complain(log, 'E0113', '*END '//wanted//' without *'//wanted, deck%block(number)%at)
      end if
   end subroutine close_place

   function opener(self, deck) result(text)
      type(place_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: text

      associate (block => deck%block(self%opened(self%depth)))
         text = '*'//block%keyword//' (line '//to_text(block%at%line)//')'
      end associate
   end function opener

   !> The deck ends: everything must be closed.
   subroutine leave_deck(self, deck, log)
      type(place_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      type(log_type), intent(inout) :: log

      if (self%depth == 0) return
      associate (block => deck%block(self%opened(self%depth)))
         call complain(log, 'E0113', '*'//block%keyword//' is not closed', block%at, &
            & label='*END '//block%keyword//' is missing')
      end associate
   end subroutine leave_deck
end module lopin_place
