!> The cards of a deck in order, with parts copied to where their instances stand.
module lopin_build_parts
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, location_type
   use lopin_text, only : parse_integer
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain
   use lopin_build_scene, only : scene_type, card_type, instance_type, name_type, need_word, &
      & no_such, find_name
   implicit none
   private
   public :: new_scene, placed

   type :: part_type
      integer :: first = 1, last = 0   !! blocks inside
   end type part_type

contains

   subroutine new_scene(self, deck, log)
      type(scene_type), intent(out) :: self
      type(deck_type), intent(in) :: deck
      type(log_type), intent(inout) :: log
      type(part_type), allocatable :: part(:)
      type(name_type), allocatable :: names(:)
      integer :: k, scope, step
      logical :: inside

      call find_parts(deck, part, names, log)
      allocate (self%card(max(16, 2*deck%nblock)), self%instance(0))
      scope = 0
      step = 0
      inside = .false.
      do k = 1, deck%nblock
         associate (block => deck%block(k))
            if (block%keyword == 'PART') inside = .true.
            if (.not. inside) then
               select case (block%keyword)
               case ('ASSEMBLY', 'END ASSEMBLY')
                  continue
               case ('INSTANCE')
                  call add_instance(self, block, part, names, log)
                  scope = size(self%instance)
               case ('END INSTANCE')
                  scope = 0
               case ('STEP')
                  self%nstep = self%nstep + 1
                  step = self%nstep
                  call add_card(self, k, 0, step)
               case ('END STEP')
                  step = 0
               case default
                  call add_card(self, k, scope, step)
               end select
            end if
            if (block%keyword == 'END PART') inside = .false.
         end associate
      end do
      allocate (self%node_offset(0:size(self%instance)), source=0)
      allocate (self%element_offset(0:size(self%instance)), source=0)
      call number_scopes(self, deck, 'NODE', self%node_offset)
      call number_scopes(self, deck, 'ELEMENT', self%element_offset)
   end subroutine new_scene

   subroutine find_parts(deck, part, names, log)
      type(deck_type), intent(in) :: deck
      type(part_type), allocatable, intent(out) :: part(:)
      type(name_type), allocatable, intent(out) :: names(:)
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: k, j
      logical :: found

      allocate (part(0), names(0))
      do k = 1, deck%nblock
         if (deck%block(k)%keyword /= 'PART') cycle
         call need_word(deck%block(k), 'NAME', name, at, found, log)
         do j = k + 1, deck%nblock
            if (deck%block(j)%keyword == 'END PART') exit
         end do
         if (j > deck%nblock) call complain(log, 'E0209', '*PART '//name//' has no *END PART', &
            & deck%block(k)%at)
         part = [part, part_type(k + 1, min(j, deck%nblock + 1) - 1)]
         names = [names, name_type(name)]
      end do
   end subroutine find_parts

   pure subroutine add_card(self, block, scope, step)
      type(scene_type), intent(inout) :: self
      integer, intent(in) :: block, scope, step
      type(card_type), allocatable :: grown(:)

      if (self%ncard == size(self%card)) then
         allocate (grown(2*self%ncard))
         grown(:self%ncard) = self%card
         call move_alloc(grown, self%card)
      end if
      self%ncard = self%ncard + 1
      self%card(self%ncard) = card_type(block, scope, step)
   end subroutine add_card

   subroutine add_instance(self, block, part, names, log)
      type(scene_type), intent(inout) :: self
      type(block_type), intent(in) :: block
      type(part_type), intent(in) :: part(:)
      type(name_type), intent(in) :: names(:)
      type(log_type), intent(inout) :: log
      type(instance_type) :: instance
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: k, j
      logical :: found

      call need_word(block, 'NAME', instance%name, at, found, log)
      instance%at = block%at
      call read_placement(instance, block, log)
      self%instance = [self%instance, instance]
      call need_word(block, 'PART', name, at, found, log)
      if (.not. found) return
      k = find_name(names, name)
      if (k == 0) then
         call no_such(log, 'part', name, names, at)
         return
      end if
      do j = part(k)%first, part(k)%last
         call add_card(self, j, size(self%instance), 0)
      end do
   end subroutine add_instance

   !> First line: translation. Second line: two points of the axis and the angle in degrees.
   subroutine read_placement(instance, block, log)
      type(instance_type), intent(inout) :: instance
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: value(7), axis(3), angle, cosine, sine
      integer :: i, j, n
      logical :: found

      instance%rotation = 0.0_wp
      do i = 1, 3
         instance%rotation(i, i) = 1.0_wp
      end do
      do j = 1, min(2, block%nline)
         call split_fields(block%line(j), field, n)
         value = 0.0_wp
         do i = 1, min(n, 7)
            call field_real(field(i), value(i), log, found)
         end do
         if (j == 1) then
            instance%shift = value(:3)
            cycle
         end if
         instance%pivot = value(:3)
         axis = value(4:6) - value(:3)
         if (.not. norm2(axis) > 0.0_wp) then
            call complain(log, 'E0209', 'the two points of the axis of rotation are the same', &
               & field(1)%at)
            return
         end if
         axis = axis/norm2(axis)
         angle = value(7)*acos(-1.0_wp)/180.0_wp
         cosine = cos(angle)
         sine = sin(angle)
         instance%rotation = cosine*instance%rotation + sine*reshape([0.0_wp, axis(3), -axis(2), &
            & -axis(3), 0.0_wp, axis(1), axis(2), -axis(1), 0.0_wp], [3, 3])
         do i = 1, 3
            instance%rotation(:, i) = instance%rotation(:, i) + (1.0_wp - cosine)*axis*axis(i)
         end do
      end do
   end subroutine read_placement

   !> Where a point of a part stands in the scene.
   pure function placed(self, scope, x) result(y)
      type(scene_type), intent(in) :: self
      integer, intent(in) :: scope
      real(wp), intent(in) :: x(3)   !! [length]
      real(wp) :: y(3)

      y = x
      if (scope == 0) return
      associate (instance => self%instance(scope))
         y = instance%pivot + matmul(instance%rotation, x + instance%shift - instance%pivot)
      end associate
   end function placed

   !> Offsets that keep the numbers of all scopes apart; all zero when they are apart already.
   subroutine number_scopes(self, deck, keyword, offset)
      type(scene_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: keyword     !! NODE or ELEMENT
      integer, intent(inout) :: offset(0:)
      integer :: low(0:size(offset) - 1), high(0:size(offset) - 1), i, j, k, label, comma, taken
      logical :: ok, apart

      if (size(offset) == 1) return
      low = huge(1)
      high = 0
      do k = 1, self%ncard
         associate (block => deck%block(self%card(k)%block), s => self%card(k)%scope)
            if (block%keyword /= keyword) cycle
            do j = 1, block%nline
               comma = index(block%line(j)%text//',', ',')
               call parse_integer(block%line(j)%text(:comma - 1), label, ok)
               if (.not. ok) cycle
               low(s) = min(low(s), label)
               high(s) = max(high(s), label)
            end do
         end associate
      end do
      apart = .true.
      do i = 0, size(offset) - 1
         do j = 0, i - 1
            apart = apart .and. (low(i) > high(j) .or. low(j) > high(i))
         end do
      end do
      if (apart) return
      taken = 0
      do i = 1, size(offset) - 1
         if (high(i) > 0) offset(i) = taken
         taken = taken + high(i)
      end do
      if (high(0) > 0) offset(0) = taken
   end subroutine number_scopes
end module lopin_build_parts
