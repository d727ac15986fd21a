!> Slave nodes that the master covers in part: which keep a row, and to which the functions of the
!> others are added.
!>
!> A node that the master covers less than its best neighbour has a weak function: as a row of its
!> own it would keep nodes beside the master at its height (force +15 %, pressures times 3 to 9).
!> Its function goes in equal parts to the kept nodes of its facets, so that the functions still sum
!> to one. On a sharp edge a node has a function for every smooth piece: of those that meet masters
!> of one direction only the piece that faces best has a row, others that face as well join it, and
!> those that do not give theirs to their piece; masters of another direction get another row.
module lopin_mortar_cover
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_list_type
   implicit none
   private
   public :: cover_type, new_cover, plan_cover, has_row, taken_over, find_late

   !> A node covered less than this share of its best neighbour is weak. Not one half: that is what
   !> a node has where an edge of the master lies along the slave's nodes.
   real(wp), parameter :: weak = 0.55_wp
   !> From increment to increment a node becomes weak below the first and is not above the second.
   real(wp), parameter :: becomes_weak = 0.50_wp, is_strong_again = 0.60_wp
   !> The same within an increment, where a change would disturb Newton's method.
   real(wp), parameter :: must_be_weak = 0.05_wp, must_be_strong = 0.95_wp
   !> An increment that ends below this was solved as if it had not lost the node on its way.
   real(wp), parameter :: lost = 0.35_wp
   !> Ties hold on at the rim.
   real(wp), parameter :: weak_tie = 0.05_wp
   !> Masters whose normals differ by more, 30 degrees, have a row each.
   real(wp), parameter :: one_direction = 0.866025403784439_wp
   !> Of two pieces that face alike, by cosine, none is better.
   real(wp), parameter :: alike = 0.05_wp
   !> A piece farther from its master than the nearest by this share of a facet is not the better.
   real(wp), parameter :: apart = 0.25_wp
   !> Of a facet: less is rounding.
   real(wp), parameter :: nothing = 1.0e-10_wp

   !> Where the function of a node without a row goes.
   type :: gift_type
      integer, allocatable :: heir(:)          !! in equal parts
   end type gift_type

   type :: state_of_node
      integer :: bare = 0, kept = 1, weak = 2, gives = 3, joins = 4
   end type state_of_node
   type(state_of_node), parameter :: is = state_of_node()

   !> Of all numbers of the slave surface.
   type :: cover_type
      logical :: tied = .false.
      integer :: least = 1                     !! rows kept, if as many nodes are covered at all
      real(wp), allocatable :: full(:)         !! areas if all were covered [area]
      real(wp), allocatable :: share(:)        !! (slave facets) of the transformed basis
      integer, allocatable :: state(:)         !! one of `is`; between increments the memory
      integer, allocatable :: owner(:)         !! of those that give or join: the better piece's
      ! Present shape
      real(wp), allocatable :: ratio(:)        !! covered share
      real(wp), allocatable :: beside(:)       !! that beside the best of the facets of the node
      real(wp), allocatable :: began(:)        !! the same where the increment began
      logical, allocatable :: facet(:)         !! (slave facets) covered
      type(gift_type), allocatable :: gift(:)
      integer, allocatable :: giver(:)         !! those that have one
   end type cover_type

contains

   !> A slave of which nothing is covered yet.
   pure subroutine new_cover(self, full, share, tied, least)
      type(cover_type), intent(out) :: self
      real(wp), intent(in) :: full(:), share(:)   !! from whole_weights
      logical, intent(in) :: tied
      integer, intent(in), optional :: least   !! rows kept

      self%full = full
      self%share = share
      self%tied = tied
      if (present(least)) self%least = least
      allocate (self%state(size(full)), source=-1)
   end subroutine new_cover

   !> From the weights and directions of the present rows. Between increments (`start`) pieces are
   !> compared anew and nodes may become weak or strong.
   subroutine plan_cover(self, slave, list, weight, direction, start)
      type(cover_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      type(overlap_list_type), intent(in) :: list
      real(wp), intent(in) :: weight(:)        !! (slave%nnode) D before any is given away [area]
      real(wp), intent(in) :: direction(:, :)  !! (3, slave%nnode) mean normal of the master there
      logical, intent(in) :: start             !! of an increment
      integer :: before(size(weight)), i

      before = self%state
      self%ratio = merge(weight/max(tiny(1.0_wp), self%full), 0.0_wp, self%full > 0.0_wp)
      self%facet = spread(.false., 1, slave%facets%n)
      do i = 1, list%n
         self%facet(list%item(i)%slave) = .true.
      end do
      self%state = is%bare
      do i = 1, slave%facets%n
         if (self%facet(i)) self%state(slave%local(:slave%facets%nnode(i), i)) = is%kept
      end do
      self%owner = spread(0, 1, size(weight))
      call compare_pieces(self, slave, list, direction, before, start)
      call find_weak(self, slave, before, start)
      if (start) self%began = self%beside
      call find_heirs(self, slave)
   end subroutine plan_cover

   !> At every node with several pieces: which have rows, join one, or give theirs away.
   subroutine compare_pieces(self, slave, list, direction, before, start)
      type(cover_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      type(overlap_list_type), intent(in) :: list
      real(wp), intent(in) :: direction(:, :)
      integer, intent(in) :: before(:)
      logical, intent(in) :: start
      real(wp) :: away(slave%nnode), facing(slave%nnode)
      logical :: sharp(slave%nnode)
      integer :: i, k, from, to

      sharp = .false.
      do i = 1, slave%nnode - 1
         if (slave%node(i) == slave%node(i + 1)) sharp(i:i + 1) = .true.
      end do
      if (.not. any(sharp .and. self%state == is%kept)) return
      away = huge(1.0_wp)
      facing = 0.0_wp
      do i = 1, list%n
         associate (o => list%item(i))
            do k = 1, slave%facets%nnode(o%slave)
               associate (at => slave%local(k, o%slave))
                  if (.not. sharp(at) .or. .not. abs(o%d(k)) > 0.0_wp) cycle
                  away(at) = min(away(at), abs(o%gap(k)/o%d(k))/slave%size(o%slave))
                  facing(at) = -dot_product(slave%disc(4:6, o%slave), direction(:, at))
               end associate
            end do
         end associate
      end do
      from = 1
      do while (from <= slave%nnode)
         to = from
         do while (to < slave%nnode)
            if (slave%node(to + 1) /= slave%node(from)) exit
            to = to + 1
         end do
         if (to > from) call compare(from, to)
         from = to + 1
      end do

   contains

      !> The numbers of one node, the best first.
      subroutine compare(from, to)
         integer, intent(in) :: from, to
         logical :: open(from:to)
         integer :: best, j

         open = self%state(from:to) == is%kept .and. self%ratio(from:to) > nothing
         do while (any(open))
            best = best_of(open)
            open(best) = .false.
            do j = from, to
               if (.not. open(j)) cycle
               if (.not. self%tied .and. dot_product(direction(:, j), direction(:, best)) &
                  & < one_direction) cycle
               open(j) = .false.
               self%owner(j) = best
               self%state(j) = is%gives
               if (self%tied .or. (facing(j) > facing(best) - alike .and. away(j) &
                  & < away(best) + apart)) self%state(j) = is%joins
               if (.not. start .and. any(before(j) == [is%gives, is%joins])) &
                  & self%state(j) = before(j)
            end do
         end do
      end subroutine compare

      !> Of the near ones the one that faces best; within an increment the one that had the row.
      integer function best_of(open) result(best)
         logical, intent(in) :: open(:)
         real(wp) :: nearest, value(size(open))
         integer :: j

         nearest = minval(away(from:to), mask=open)
         value = -huge(1.0_wp)
         do j = 1, size(open)
            if (.not. open(j)) cycle
            value(j) = facing(from + j - 1)
            if (away(from + j - 1) > nearest + apart) value(j) = value(j) - 2.0_wp
            if (.not. start .and. any(before(from + j - 1) == [is%kept, is%weak])) &
               & value(j) = value(j) + 4.0_wp
         end do
         best = from - 1 + maxloc(value, dim=1)
         do j = 1, size(open)
            ! The first of those that face alike, so that rounding does not decide.
            if (open(j) .and. value(j) > value(best - from + 1) - 1.0e-6_wp) exit
         end do
         best = from - 1 + j
      end function best_of
   end subroutine compare_pieces

   !> The nodes whose functions are weak beside the best of their covered facets.
   subroutine find_weak(self, slave, before, start)
      type(cover_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: before(:)
      logical, intent(in) :: start
      real(wp) :: best(slave%nnode), most, limit
      integer :: i, k

      best = 0.0_wp
      do i = 1, slave%facets%n
         if (.not. self%facet(i)) cycle
         associate (own => slave%local(:slave%facets%nnode(i), i))
            most = maxval([0.0_wp, pack(self%ratio(own), self%state(own) == is%kept)])
            best(own) = max(best(own), most)
         end associate
      end do
      self%beside = merge(self%ratio/max(tiny(1.0_wp), best), 1.0_wp, best > 0.0_wp)
      do i = 1, slave%nnode
         if (self%state(i) /= is%kept) cycle
         limit = weak
         if (start .and. before(i) == is%kept) limit = becomes_weak
         if (start .and. before(i) == is%weak) limit = is_strong_again
         if (.not. start .and. before(i) == is%kept) limit = must_be_weak
         if (.not. start .and. before(i) == is%weak) limit = must_be_strong
         if (self%tied) limit = weak_tie
         if (self%ratio(i) < limit*best(i)) self%state(i) = is%weak
      end do
      do while (count(self%state == is%kept) < self%least)
         k = maxloc(self%ratio, dim=1, mask=self%state == is%weak)
         if (k == 0) exit
         self%state(k) = is%kept
      end do
   end subroutine find_weak

   !> To whom each node that has no row gives its function.
   subroutine find_heirs(self, slave)
      type(cover_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      logical :: open(slave%nnode)
      integer :: j, best

      if (allocated(self%gift)) deallocate (self%gift)
      allocate (self%gift(slave%nnode))
      ! The most covered first: what a node receives is settled when its neighbour asks.
      open = self%state == is%weak
      do while (any(open))
         j = maxloc(self%ratio, dim=1, mask=open)
         open(j) = .false.
         call ask_around(self, slave, j, self%gift(j)%heir, best)
         if (size(self%gift(j)%heir) > 0) cycle
         if (best == 0) then
            self%state(j) = is%kept
         else if (self%state(best) == is%weak) then
            self%gift(j)%heir = self%gift(best)%heir
         end if
      end do
      do j = 1, slave%nnode
         if (.not. any(self%state(j) == [is%gives, is%joins])) cycle
         self%gift(j)%heir = [integer ::]
         if (self%state(j) == is%gives) call ask_around(self, slave, j, self%gift(j)%heir, best)
         if (size(self%gift(j)%heir) > 0) cycle
         self%gift(j)%heir = [self%owner(j)]
         if (self%state(self%owner(j)) == is%weak) self%gift(j)%heir = self%gift(self%owner(j))%heir
      end do
      self%giver = pack([(j, j=1, slave%nnode)], self%state > is%kept)
   end subroutine find_heirs

   !> The kept nodes of the covered facets of a node, and the best of its weak ones that is better.
   pure subroutine ask_around(self, slave, j, heir, best)
      type(cover_type), intent(in) :: self
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: j
      integer, allocatable, intent(out) :: heir(:)
      integer, intent(out) :: best             !! 0: none
      integer :: i, k, f
      integer, allocatable :: around(:)

      heir = [integer ::]
      best = 0
      call facets_at(slave, j, around)
      do f = 1, size(around)
         i = around(f)
         if (.not. self%facet(i)) cycle
         do k = 1, slave%facets%nnode(i)
            if (slave%local(k, i) /= j) call ask(slave%local(k, i), heir, best)
         end do
      end do

   contains

      pure subroutine ask(other, heir, best)
         integer, intent(in) :: other
         integer, allocatable, intent(inout) :: heir(:)
         integer, intent(inout) :: best

         if (self%state(other) == is%kept) then
            if (.not. any(heir == other)) heir = [heir, other]
         else if (self%state(other) == is%weak) then
            if (.not. self%ratio(other) > self%ratio(j)) return
            if (best > 0) then
               if (.not. self%ratio(other) > self%ratio(best)) return
            end if
            best = other
         end if
      end subroutine ask
   end subroutine ask_around

   !> The facets of a node; of a mid-side node those of its ends that have it.
   pure subroutine facets_at(slave, j, list)
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: j
      integer, allocatable, intent(out) :: list(:)
      integer :: i

      list = slave%ring(slave%ring_first(j):slave%ring_first(j + 1) - 1)
      if (size(list) > 0) return
      list = pack([(i, i=1, slave%facets%n)], any(slave%local == j, dim=1))
   end subroutine facets_at

   !> Whether function j has a row of its own.
   pure logical function has_row(self, j)
      type(cover_type), intent(in) :: self
      integer, intent(in) :: j
      has_row = self%state(j) == is%kept
   end function has_row

   !> The node that has a row still though the increment has taken the most of it off the master,
   !> and the part of the increment after which its row should have ended.
   pure subroutine find_late(self, node, part)
      type(cover_type), intent(in) :: self
      integer, intent(out) :: node             !! of the slave; 0: none
      real(wp), intent(out) :: part
      logical :: late(size(self%state))

      node = 0
      part = 1.0_wp
      if (self%tied .or. .not. allocated(self%began)) return
      if (count(self%state == is%kept) <= self%least) return
      late = self%state == is%kept .and. self%beside < lost .and. self%began >= becomes_weak
      if (.not. any(late)) return
      node = minloc(self%beside, dim=1, mask=late)
      associate (from => self%began(node), to => self%beside(node))
         part = (from - 0.5_wp*(becomes_weak + lost))/(from - to)
      end associate
   end subroutine find_late

   !> Nodes whose functions a node takes over, and which share of each.
   pure subroutine taken_over(self, j, from, share)
      type(cover_type), intent(in) :: self
      integer, intent(in) :: j
      integer, allocatable, intent(out) :: from(:)
      real(wp), allocatable, intent(out) :: share(:)
      integer :: i

      from = [integer ::]
      share = [real(wp) ::]
      do i = 1, size(self%giver)
         associate (heir => self%gift(self%giver(i))%heir)
            if (.not. any(heir == j)) cycle
            from = [from, self%giver(i)]
            share = [share, 1.0_wp/real(size(heir), wp)]
         end associate
      end do
   end subroutine taken_over
end module lopin_mortar_cover
